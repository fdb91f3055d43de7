#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether what README, the pages and the comments say of the tree is true.

usage: tests/maps.py          ends with `N passed, N failed`
       tests/maps.py --faults lists all that fails, without the planted faults

Each check gets the tree as a dictionary of texts and returns how much it looked
at and the faults. Then a fault of each kind is planted, which the check must see.
"""
import collections
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "ci"))
import mutate  # noqa: E402: it lies in ci/

ROOMS = ("ref", "gpu", "tests", "spec", "app")
# The rooms of app/, each of which includes itself and those before it.
TOOL = ("base", "read", "scene", "write", "render", "tool")
MOST_FILES = 30    # in a room
MOST_HEADERS = 40  # of ours that a .cu file sees
C = (".c", ".h", ".cu", ".cuh", ".cpp", ".def")
SCRIPTS = (".sh", ".py", ".mk", "Makefile", ".ci/run")
LOGS = ("bench/h200/", "CHANGELOG")  # they tell of trees that were
SUFFIX = r"(?:c|h|cu|cuh|cpp|md|sh|py|def|gappa|mk)"
FILE = re.compile(r"(?<![\w./<*-])((?:[\w-]+/)*[\w-]+\." + SUFFIX + r")(?![\w/])")
CITED = re.compile(r"(?P<page>(?:[\w-]+/)*[\w-]+\.md)|§ ?(?P<n>\d+(?:\.\d+)*)")
# Which § is of a paper, a book or a standard.
ELSEWHERE = re.compile(r"(?:\b(?:19|20)\d\d|C17|C\+\+\d\d|RFC \d+)[a-z]?,? $")
# Names of pages when they had numbers.
NUMBERED = re.compile(r"\b\d\d_[a-z]+|spec/\d\d\b|\bpages? \d\d\b|"
                      r"(?<![\w.,–-])\(\d\d\)|(?<![\w.,–-])\d\d §|"
                      r"\d\d → \d\d|(?<![\w.,–§])(?<![Ff]igure )[0-5]\d's\b|"
                      r"\b(?:as|with|by(?! 32)) 3[1-9](?= (?:held|took|does)\b|[,.;:)])")


def tree():
    """All texts of the checkout: path to text."""
    texts = {}
    for at, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if f not in
                      ("build", ".git", "__pycache__", "corpus", "shared")]
        for name in names:
            path = os.path.relpath(os.path.join(at, name), ROOT)
            if path.endswith(C + SCRIPTS + (".md", ".gappa", ".equivalent")):
                with open(os.path.join(at, name), encoding="utf-8") as file:
                    texts[path] = file.read()
            else:
                texts.setdefault(path, "")
    return texts


def comments(path, text):
    """The comments of a source as (line, text), without its marks."""
    found = []
    if path.endswith(C):
        # a string or a character may hold what looks like a comment
        for m in re.finditer(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|'
                             r"/\*.*?\*/|//[^\n]*", text, re.S):
            if m[0][0] == "/":
                words = re.sub(r"\n\s*\*?", " ", m[0].strip("/* "))
                found.append((text.count("\n", 0, m.start()) + 1,
                              " ".join(words.split())))
    elif path.endswith(SCRIPTS):
        for m in re.finditer(r'^[ \t]*# [^\n]*(?:\n[ \t]*#[^\n]*)*|^ *""".*?"""',
                             text, re.M | re.S):
            words = re.sub(r"^[ \t]*#", " ", m[0], flags=re.M)
            found.append((text.count("\n", 0, m.start()) + 1,
                          " ".join(words.split())))
    return found


def sources(texts):
    return [path for path in texts if path.endswith(C + SCRIPTS) and
            path.split("/")[0] in ("ref", "gpu", "tests", "app", "fuzz", "oracle",
                                   "ci", "bench", "validate", "spec", "Makefile")]


def pages(texts):
    return [path for path in texts if path.endswith(".md") and
            not path.startswith(LOGS)]


def table(texts):
    return re.findall(r"^STAGE\((\w+), (\w+), (\w+), \w+\)",
                      texts["spec/stages.def"], re.M)


def diagram(texts):
    """The first fenced block of README that has lines between stages."""
    for block in texts["README.md"].split("\n```")[1::2]:
        if "─" in block:
            return block.split("\n", 1)[1] + "\n"
    return ""


def check_diagram(texts):
    names = [name for _, _, name in table(texts)]
    block, faults = diagram(texts), []
    drawn = re.findall(r"([a-z_]+) *(?=[─⇄+])", block)
    drawn += re.findall(r"[─⇄+] *([a-z_]+)", block)
    words = set(re.findall(r"[a-z_]+", block))
    faults += [f"README.md: the diagram has {name}, which is no stage"
               for name in sorted(set(drawn) - set(names))]
    faults += [f"README.md: the diagram leaves out {name}"
               for name in names if name not in words]
    return len(names), faults


def fields(texts, room, file, name):
    """The streams of a stage as its test has them: kind and extent of each."""
    text = texts.get(f"tests/{room}/{file}.c", "")
    body = re.search(rf"struct field fields_{name}\[\] = {{(.*?)FIELD_END", text, re.S)
    body, found = re.sub(r"\s+", " ", body[1] if body else ""), {}
    if "FABRIC_BVTT" in body:
        found.update(box=("IN", "in.tree.n"), clear=("IN", "in.tree.n_cloth"))
    for kind, of in re.findall(r"\b(INOUT|IN|OUT_USED|OUT_VALUE|OUT|SCRATCH)\((.*?)\)",
                               body):
        part = re.split(r", *", of)
        extent = f"[{part[-1] if kind == 'OUT_USED' else part[2]}]" if part[2:] else ""
        per = part[3] if part[3:] else "1"
        found[part[1]] = kind, extent + (f"[{per}]" if per != "1" else "")
    for at, used in re.findall(r"FIELD_\(FIELD_INOUT, \w+, (\w+), 1, .*?, "
                               r"\(long\)offsetof\(struct \w+, (\w+)\), 0\)", body):
        found[at] = "INOUT", f"[{used}]"
    return found


def fenced(texts, path, kind):
    block = re.search(rf"^```{kind}\n(.*?)^```", texts[path], re.M | re.S)
    return block[1] if block else ""


def check_flow(texts):
    """Rows of spec/README.md's streams: each stage once and in README's part, with
    streams that it reads and writes, of these extents; what it reads was written
    before. The picture has these streams and parts alone."""
    page, faults, rows, part, seen = "spec/README.md", [], 0, "", set()
    parts = {line.split()[0]: set(re.findall(r"[a-z_]+", line)[1:])
             for line in diagram(texts).splitlines() if line.strip()}
    parts["broad-phase"] = parts.get("broad-phase", set()) - {"phase"}
    homes = {name: (room, file) for room, file, name in table(texts)}
    known, drawn = {"start"}, fenced(texts, page, "streams")

    def fault(text):
        faults.append(f"{page}: the streams: {text}")
    for line in drawn.splitlines():
        reads, arrow, writes = line.partition("→")
        words = reads.split()
        if line[:1] != " ":
            part = words.pop(0)
        if not arrow:  # what is there before the first stage
            known.update(word for word in re.split(r"  +", line[13:])[0].split())
            continue
        name, rows = words.pop(0), rows + 1
        have = fields(texts, *homes[name], name) if name in homes else {}
        if name in seen or name not in homes or name not in parts.get(part, ()):
            fault(f"{name} is no stage of {part}, or is there twice")
            continue
        seen.add(name)
        for word in words:
            own, _, source = word.partition("=")
            if have.get(own, "?")[0] not in ("IN", "INOUT"):
                fault(f"{name} does not read {own}")
            if (source or own) not in known:
                fault(f"nothing before {name} writes {source or own}")
        for group in re.findall(r"([^\[\],]+)((?:\[[\w.]+\])*)", writes):
            for word in group[0].split():
                own, _, target = word.partition("=")
                kind, extent = have.get(own, ("?", ""))
                if kind not in ("OUT", "OUT_USED", "OUT_VALUE", "INOUT"):
                    fault(f"{name} does not write {own}")
                elif extent != group[1]:
                    fault(f"{name} writes {own} {extent}, not {group[1]}")
                known.add(target or own)
    for name in set(homes) - seen:
        fault(f"{name} is not there")
    picture = fenced(texts, page, "picture")
    inside = set(" ".join(re.findall(r"\(([^)]*)\)", picture)).split())
    outside = [word for line in picture.splitlines() if re.match("  [a-z]", line)
               for word in re.split("   |◄", line[2:])[0].split()]
    for word in sorted(inside - known) + sorted(set(outside) - set(parts)):
        fault(f"the picture has {word}, which is no stream or part")
    return rows + len(inside) + len(outside), faults


def check_stages(texts):
    faults = []
    for room, file, name in table(texts):
        page = f"spec/{room}/{file}.md"
        four = (page, f"ref/{room}/{file}.c", f"gpu/{room}/{file}.cu",
                f"tests/{room}/{file}.c")
        faults += [f"stage {name}: there is no {path}"
                   for path in four if path not in texts]
        named = texts.get(page, "")
        for function, top, end in ((f"ref_{name}", "ref", ".c"),
                                   (f"gpu_{name}", "gpu", ".cu")):
            homes = [path for path in texts if path.startswith(f"{top}/{room}/")
                     and path.endswith(end) and
                     re.search(rf"^(?:extern \"C\" )?int {function}\(",
                               texts[path], re.M)]
            if not homes:
                faults.append(f"stage {name}: {top}/{room} has no {function}")
            faults += [f"{page} does not name {home}, which has {function}"
                       for home in homes
                       if home != f"{top}/{room}/{file}{end}" and
                       home not in named]
        if f"gen_{name}(" not in texts.get(four[3], ""):
            faults.append(f"stage {name}: {four[3]} has no gen_{name}")
    return len(table(texts)), faults


def check_files(texts):
    """Every file that is named exists."""
    bases = {os.path.basename(path) for path in texts}
    system = set(re.findall(r"#\s*include <([^>]+)>", "\n".join(
        text for path, text in texts.items() if path.endswith(C))))
    system |= {os.path.basename(name) for name in system}
    seen, faults = 0, []

    def look(path, line, text):
        nonlocal seen
        text = re.sub(r"\w+://\S+|\.\./shared/\S+|build/\S+|made/\S+", " ",
                      text)  # what is made is not in the tree
        for name in FILE.findall(text):
            if re.search(r"(?:^|/)[A-Z_]+\.", name) and name not in texts:
                continue  # a pattern: ROOM/FILE.c
            seen += 1
            near = os.path.normpath(os.path.join(os.path.dirname(path), name))
            if not (name in texts or near in texts or name in system or
                    ("/" not in name and name in bases)):
                faults.append(f"{path}:{line}: there is no {name}")
    for path in sources(texts):
        for line, text in comments(path, texts[path]):
            look(path, line, text)
    for path in pages(texts):
        for k, text in enumerate(texts[path].split("\n")):
            look(path, k + 1, text)
    return seen, faults


def sections(text):
    """The numbers of a page's sections, as text to what stands there."""
    found, top, now, headed = {}, None, None, "\n## 1" in text
    for line in text.split("\n"):
        head = re.match(r"#+ (\d+(?:\.\d+)*)\b", line)
        item = re.match(r"( *)(\d+(?:\.\d+)*)\.? ", line)
        if head:
            top = now = head[1]
            found[now] = ""
        elif item and "." in item[2]:
            now = item[2]
            found[now] = ""
        elif item and re.match(r" *\d+\. ", line):
            if headed:
                now = f"{top}.{item[2]}"
            elif not item[1]:
                top = now = item[2]
            else:
                now = f"{top}.{item[2]}"
            found[now] = ""
        if now:
            for at in {now, top}:
                found[at] = found.get(at, "") + " " + line
    # items that stand within a paragraph: `7. Tested. 1 A motion's ...`
    for at, part in list(found.items()):
        for n in re.findall(r"[.:;*] +(\d) [A-Z]", part):
            found.setdefault(f"{at}.{n}", part)
    return found


def page_of(texts, name, path):
    """The path of the page that a comment or a page names."""
    near = os.path.normpath(os.path.join(os.path.dirname(path), name))
    if near in texts and "/" not in name:
        return near
    for at in (name, "spec/" + name):
        if at in texts and at != "README.md":
            return at
    found = [at for at in texts if at.startswith("spec/") and
             os.path.basename(at) == name]
    return found[0] if len(found) == 1 else None


def own_pages(texts, path):
    """The pages that the head comment of a file names, or its header's."""
    head = " ".join(text for line, text in comments(path, texts[path])
                    if line < 12)
    found = [page_of(texts, name, path)
             for name in re.findall(r"(?:[\w-]+/)*[\w-]+\.md", head)]
    stem = os.path.splitext(path)[0]
    for end in (".h", ".cuh"):
        if not found and path != stem + end and stem + end in texts:
            found = own_pages(texts, stem + end)
    room = path.split("/")[1:]
    same = "spec/" + os.path.splitext("/".join(room))[0] + ".md"
    return [at for at in dict.fromkeys(found + [same]) if at in texts]


def citations(texts, path, text, own):
    """(§, the pages it may be on or None for an unknown one, what follows)."""
    last, end = None, -1
    for m in CITED.finditer(text):
        if m["page"]:
            last, end = [page_of(texts, m["page"], path)], m.end()
            continue
        before = text[:m.start()]
        if ELSEWHERE.search(before):
            continue
        joined = end >= 0 and re.fullmatch(
            r"(?:'s)?[ ,;]*(?:and |to |or )?", text[end:m.start()])
        at = last if joined else own
        last, end = at, m.end()
        yield m["n"], at, text[m.end():]


def alike(heading, text):
    """Whether a heading's words, or what they begin with, are in a text."""
    begins = [word[:5].lower() for word in heading.split() if len(word) > 3]
    return any(word in text.lower() for word in begins) or not begins


def check_citations(texts):
    cache, seen, faults = {}, 0, []

    def parts(page):
        if page not in cache:
            cache[page] = sections(texts[page])
        return cache[page]

    def look(path, line, text, own, bare):
        nonlocal seen
        for n, at, after in citations(texts, path, text, own):
            if at is own and not bare:
                continue
            seen += 1
            known = [page for page in at if page]
            if not known:
                faults.append(f"{path}:{line}: §{n} of no page")
                continue
            have = [page for page in known if n in parts(page)]
            if not have:
                faults.append(f"{path}:{line}: no §{n} on {', '.join(known)}")
                continue
            words = re.match(r" (?:[\"“])?([A-Z][a-z]+(?: [a-z]+){0,5})"
                             r"(?:[\"”])?(?: ----)?\.?$", after)
            if words and text.startswith(("§", "---- §")) and not any(
                    alike(words[1], parts(page)[n]) for page in have):
                faults.append(f"{path}:{line}: §{n} of {have[0]} has no word of "
                              f"'{words[1]}'")
    for path in sources(texts):
        own = own_pages(texts, path)
        for line, text in comments(path, texts[path]):
            look(path, line, text, own, True)
    for path in pages(texts):
        for k, text in enumerate(texts[path].split("\n")):
            look(path, k + 1, text, [path], path.startswith("spec/") and
                 path != "spec/errata.md")  # whose § are the paper's
    return seen, faults


def check_rooms(texts):
    count = {}
    for path in texts:
        part = path.split("/")
        if part[0] in ROOMS and len(part) > 2:
            count["/".join(part[:2])] = count.get("/".join(part[:2]), 0) + 1
    return len(count), [f"{room} has {n} files, more than {MOST_FILES}"
                        for room, n in sorted(count.items()) if n > MOST_FILES]


def includes(texts):
    """Path to the paths of ours that it includes."""
    found = {}
    for path in texts:
        if path.endswith(C):
            names = re.findall(r'^\s*#\s*include "([^"]+)"', texts[path], re.M)
            near = os.path.dirname(path)
            found[path] = [at for name in names for at in
                           (name, "spec/" + name, os.path.normpath(
                               os.path.join(near, name))) if at in texts]
    return found


# The rooms of ref/ and gpu/, each of which includes only itself and rooms before it.
# Rooms on one line are one: `run` is what a device adds to `base`, and `compare` a
# second solver.
ORDER = (("base", "run"), ("cloth",), ("panel",), ("solve", "compare"), ("broad",), ("narrow",),
         ("contact",), ("seam",), ("momentum",), ("sleep",), ("world",), ("control",),
         ("api",))
RANK = {room: k for k, rooms in enumerate(ORDER) for room in rooms}
# What still reaches up, and so takes more than it uses.
REACH_UP = """
gpu/cloth/rate.cuh gpu/solve/edges.cuh
gpu/cloth/sheet.h ref/world/sheet.h
gpu/solve/joint.cu gpu/contact/joint.h
gpu/solve/joint.cu gpu/contact/links.cuh
ref/contact/kept.c ref/sleep/rest.h
ref/contact/kept.c ref/world/state.h
ref/contact/lagrange.c ref/sleep/sleep.h
ref/contact/lagrange.c ref/world/state.h
ref/contact/unknowns.c ref/world/state.h
ref/momentum/conserve.c ref/world/state.h
ref/seam/seam.h ref/world/state.h
ref/sleep/rest.h ref/world/state.h
ref/sleep/sleep.c ref/world/slice.h
ref/solve/joint.c ref/sleep/sleep.h
ref/solve/joint.c ref/world/state.h
ref/solve/joint.h ref/contact/coulomb.h
ref/world/checkpoint.c ref/control/control.h
ref/world/step.c ref/control/control.h
"""


def reaches_up(texts):
    """(file, header) of ref/ and gpu/ where the header is of a room above."""
    found = []
    for path, named in includes(texts).items():
        room = path.split("/")[1] if path.startswith(("ref/", "gpu/")) else ""
        for name in named if room else ():
            other = name.split("/")[1] if name.startswith(("ref/", "gpu/")) else room
            if RANK.get(other, len(ORDER)) > RANK.get(room, -1) or room not in RANK:
                found.append((path, name))
    return found


def check_order(texts):
    """No file includes a header of a room above it but those that are listed, and
    each that is listed does."""
    up = reaches_up(texts)
    listed = [tuple(line.split()) for line in REACH_UP.strip().splitlines()]
    seen = sum(path.startswith(("ref/", "gpu/")) for path in includes(texts))
    return seen, [f"{path} reaches up to {name}" for path, name in sorted(up)
                  if (path, name) not in listed] + [
        f"tests/maps.py: {path} no longer reaches up to {name}"
        for path, name in listed if (path, name) not in up]


def check_tool(texts):
    """No file of the tool includes one of a room behind its own."""
    seen, faults = 0, []
    for path, named in includes(texts).items():
        mine = path.split("/")
        if mine[0] != "app" or mine[1] not in TOOL:
            continue
        for name in named:
            room = name.split("/")[1] if name.startswith("app/") else TOOL[0]
            seen += 1
            if room not in TOOL[:TOOL.index(mine[1]) + 1]:
                faults.append(f"{path} includes {name}, of a room behind its own")
    return seen, faults


def check_circles(texts):
    """A header and the source of its name are one file here: no such files
    include each other in a circle. A header without a source is nobody's."""
    graph = {os.path.splitext(path)[0]: set() for path in texts
             if path.endswith((".c", ".cu", ".cpp"))}
    for path, named in includes(texts).items():
        stem = os.path.splitext(path)[0]
        if stem in graph:
            graph[stem].update(
                other for other in (os.path.splitext(name)[0] for name in named)
                if other in graph and other != stem)
    reach = {}
    for start in graph:
        seen, todo = set(), list(graph[start] - {start})
        while todo:
            at = todo.pop()
            if at not in seen:
                seen.add(at)
                todo += graph.get(at, ())
        reach[start] = seen
    circles = {tuple(sorted([a] + [b for b in reach[a] if a in reach.get(b, ())
                                   and b != a])) for a in graph if a in reach[a]}
    return len(graph), ["a circle: " + ", ".join(circle)
                        for circle in sorted(circles) if len(circle) > 1]


def headers(texts):
    """.cu file to the headers of ours that it sees."""
    named, found = includes(texts), {}
    for path in texts:
        if path.startswith("gpu/") and path.endswith(".cu"):
            seen, todo = set(), [path]
            while todo:
                for name in named.get(todo.pop(), ()):
                    if name not in seen:
                        seen.add(name)
                        todo.append(name)
            found[path] = seen
    return found


def check_headers(texts):
    found = headers(texts)
    return len(found), [
        f"{path} sees {len(seen)} headers, more than {MOST_HEADERS}"
        for path, seen in sorted(found.items(), key=lambda at: -len(at[1]))
        if len(seen) > MOST_HEADERS]


def check_banners(texts):
    mark = re.compile(r"^\s*(?:/\*|//|#) ?-{4}", re.M)
    found = [path for path in sources(texts) if mark.search(texts[path])]
    return len(sources(texts)), [
        f"{path}: {len(mark.findall(texts[path]))} banners" for path in found]


def check_numbers(texts):
    """No page is called by the number that it once had."""
    seen, faults = 0, []
    for path in sources(texts):
        if path == "tests/maps.py":
            continue
        for line, text in comments(path, texts[path]):
            seen += 1
            faults += [f"{path}:{line}: a page by its number: {m[0]}"
                       for m in NUMBERED.finditer(text)]
    for path in pages(texts):
        for k, text in enumerate(texts[path].split("\n")):
            faults += [f"{path}:{k + 1}: a page by its number: {m[0]}"
                       for m in NUMBERED.finditer(text) if text[:1] != "|"]
    return seen, faults


def check_equivalents(texts):
    """Each row of ci/mutants.equivalent is a fault that can still be planted: a
    line that was reworded may mean something else now."""
    rows, faults, changes = 0, [], {}
    for row in texts["ci/mutants.equivalent"].split("\n"):
        if not row.strip() or row.startswith("#"):
            continue
        path, line, change, _ = (x.strip() for x in row.split(" | ", 3))
        if path in texts and path not in changes:
            changes[path] = {(m.text, m.changes[0][2].what) for m in
                             [*mutate.mutants_of(path, texts),
                              *mutate.twins_of(path, texts)]}
        rows += 1
        if (line, change) not in changes.get(path, ()):
            faults.append(f"ci/mutants.equivalent: {path} has no such fault: "
                          f"{line} | {change}")
    return rows, faults


def check_targets(texts):
    """Each function of spec/drape.h is called by a fuzz target."""
    bare = re.sub(r"/\*.*?\*/", "", texts["spec/drape.h"], flags=re.S)
    functions = set(re.findall(r"^(?!typedef)[\w *]*\b(drape_\w+)\(", bare, re.M))
    named = {t.text for path in texts if re.fullmatch(r"fuzz/\w+\.c", path)
             for t in mutate.tokens(texts[path]) if t.kind == "name"}
    return len(functions), [f"spec/drape.h: no fuzz target calls {name}"
                            for name in sorted(functions - named)]


# #define X number, enum { X = number }, static const type X = number.
CONSTANT = re.compile(
    r"^#define (?P<a>\w+) +(?:R\(|\()?-?\.?\d|\benum \{ (?P<b>\w+) = [^,}]*\}|"
    r"^static const (?:real|double|int|int64_t|uint64_t) (?P<c>\w+) = ", re.M)
# What a function asks of its callers, as its header says, and no code reads.
ASKED = {"EXACT_LEAST"}


def check_constants(texts):
    """Each constant of ref/, gpu/ and app/ is read there: a bound that is proved,
    or a number that a page has, is not if the code has another in its place."""
    bare = {path: re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
            for path, text in texts.items()
            if path.endswith(C) and path.split("/")[0] in ("ref", "gpu", "app")}
    named = {path: collections.Counter(re.findall(r"[A-Za-z_]\w*", text))
             for path, text in bare.items()}
    everywhere = sum(named.values(), collections.Counter())
    seen, faults = 0, []
    for path, text in bare.items():
        for m in CONSTANT.finditer(text):
            name = m["a"] or m["b"] or m["c"]
            own = path.endswith((".c", ".cu", ".cpp"))  # nobody else's
            places = named[path] if own else everywhere
            times = len(re.findall(rf"(?:#define|enum \{{|static const \w+) {name}\b",
                                   text if own else "\n".join(
                                       bare[p] for p in bare if named[p][name])))
            seen += 1
            if places[name] <= times and name not in ASKED:
                faults.append(f"{path}: nothing reads {name}")
    return seen, faults


def check_commands(texts):
    """.ci/run types README's two commands, before any other."""
    block = re.search(r"^## Two commands\n.*?^```sh\n(.*?)^```", texts["README.md"],
                      re.M | re.S)[1]
    told = [re.sub(r"\s+#.*", "", line) for line in block.splitlines()]
    typed = re.findall(r"'([^']+)'", texts[".ci/run"].partition("commands=(")[2])
    return len(told), [f"README.md: .ci/run does not type {line}"
                       for line, other in zip(told, typed) if line != other]


CHECKS = (check_diagram, check_flow, check_stages, check_files, check_citations, check_rooms,
          check_order, check_tool, check_circles, check_headers, check_banners, check_numbers,
          check_equivalents, check_targets, check_constants, check_commands)


def planted(texts):
    """Of each kind a fault: the check, and the texts that it changes."""
    home, page = "ref/contact/impulses.c", "spec/contact/impulses.md"

    def edit(path, old, new):
        assert old in texts[path], f"{path}: {old}"
        return {path: texts[path].replace(old, new, 1)}

    def add(path, text):
        return {path: texts[path] + text}
    block = diagram(texts)
    yield check_diagram, edit("README.md", block, block + "refit ─ nothing\n")
    yield check_diagram, edit("README.md", block, re.sub(
        r"\bimpulses\b", "", block))
    yield check_diagram, add("spec/stages.def", "STAGE(cloth, wind, gale, EXACT)\n")
    for old, new in (("dv   ", "dw   "), ("→ toi tier [n]", "→ toi tier [nv]"),
                     ("→ toi tier [n]", "→ toi pair [n]"), ("u rest=b", "u rest=r"),
                     ("conserve     moments", "near         moments"),
                     ("( front )", "( fronts )"), ("prescribe  move", "prescribes  move")):
        yield check_flow, edit("spec/README.md", old, new)
    for name in ("spin", "sum"):
        yield check_flow, edit("spec/README.md", re.search(
            rf"^.* {name} .*→.*\n", texts["spec/README.md"], re.M)[0], "")
    yield check_flow, edit("tests/narrow/narrow.c", "OUT(narrow, tier,",
                           "OUT(narrow, level,")
    yield check_stages, add("spec/stages.def", "STAGE(cloth, gale, wind, EXACT)\n")
    yield check_stages, add("spec/stages.def", "STAGE(cloth, wind, gale, EXACT)\n")
    for path in (page, home, "gpu/contact/impulses.cu",
                 "tests/contact/impulses.c"):
        yield check_stages, {path: None}
    for path in (page, "README.md"):
        yield check_files, add(path, "\nSee `ref/contact/nothing.c`.\n")
    yield check_files, add(home, "/* See nothing.h. */\n")
    yield check_files, add("ci/part.sh", "# See ci/nothing.sh.\n")
    yield check_citations, add(home, "/* §99: nothing. */\n")
    yield check_citations, add(home, "/* spec/contact/zones.md §99 */\n")
    yield check_citations, add(home, "/* zones.md §1, §99 */\n")
    yield check_citations, add(home, "/* nothing.md §1 */\n")
    yield check_citations, add(home, "/* §1 Another thing */\n")
    yield check_citations, add("app/tool/main.c", "/* §1: of no page. */\n")
    yield check_citations, add(page, "\nSee zones.md §99.\n")
    yield check_citations, edit(page, "\n1. ", "\n7. ")
    yield check_rooms, {f"ref/cloth/more{k}.c": "" for k in range(MOST_FILES)}
    yield check_tool, add("app/read/mesh.c", '#include "app/scene/look.h"\n')
    yield check_circles, add("ref/base/keys.c", '#include "ref/contact/impulses.h"\n')
    for path, name in (("ref/base/keys.c", "ref/cloth/cloth.h"),
                       ("gpu/solve/pcg.cuh", "ref/world/state.h")):
        yield check_order, add(path, f'#include "{name}"\n')
    yield check_order, edit("ref/solve/joint.c", '#include "ref/world/state.h"\n', "")
    yield check_headers, {"gpu/cloth/more.cu": "".join(
        f'#include "ref/more{k}.h"\n' for k in range(MOST_HEADERS + 1)),
        **{f"ref/more{k}.h": "" for k in range(MOST_HEADERS + 1)}}
    yield check_banners, add(home, "/* ---- A part ---- */\n")
    yield check_numbers, add(home, "/* As 31_response §2 says. */\n")
    yield check_numbers, add(page, "\nSee 31 §2.\n")
    thin = "real_min(real_abs(a), most)"
    yield check_equivalents, edit("ref/base/packed.h", thin, thin.replace("(a)", "(b)"))
    yield check_equivalents, add("ci/mutants.equivalent", f"{home} | x | y | z\n")
    yield check_targets, add("spec/drape.h", "int drape_more(int many);\n")
    yield check_constants, edit("ref/world/slice.c", "CELLS * w->cell", "4 * w->cell")
    yield check_constants, edit("ref/sleep/sleep.c", "* DRIFT *", "* 1e-3 *")
    yield check_commands, edit("README.md", "&& make demo", "&& make")
    yield check_commands, edit(".ci/run", "'make check'", "'make -k check'")
    yield check_targets, edit("fuzz/reads.c", "drape_borrow(", "borrow(")


def main():
    texts, passed, failed, before = tree(), 0, 0, {}
    for check in CHECKS:
        seen, faults = check(texts)
        before[check] = set(faults)
        passed += max(seen - len(faults), 0)
        failed += len(faults) + (seen == 0)
        print("".join(f"not ok {fault}\n" for fault in faults), end="")
    if "--faults" in sys.argv[1:]:
        sys.exit(failed > 0)
    for k, (check, changes) in enumerate(planted(texts)):
        other = {**texts, **changes}
        other = {path: text for path, text in other.items() if text is not None}
        good = set(check(other)[1]) - before[check]
        passed += bool(good)
        failed += not good
        if not good:
            print(f"not ok {check.__name__} does not see planted fault {k}: "
                  f"{', '.join(changes)}")
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed > 0)


main()
