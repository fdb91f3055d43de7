#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Models of kernels in which threads work together, checked under every schedule.

usage: ci/models/models.py BUILD [--quick] [MODEL...]    ends with `N passed, N failed`

A model is ci/models/NAME.pml, in Promela; Spin checks it for all orders of its
threads, without races (ci/models/memory.pml) and with its assertions. Faults are
planted in it, one at a time: each barrier and each fence is left out, and so is what
FAULT(name) names. Spin must find each. A barrier that a comment `spare:` follows is no
part of the proof: without it the model must hold, too. --quick plants none.

A line `code FILE FUNCTION: TOKENS` of the model's first comment says what the function
that it models does with memory and threads, in the order of its text: barriers, fences,
atomics, and the shared arrays that it reads (s) and writes (s=). It must be the code's,
and the model's inline or process of the same name must have the same barriers, fences
and atomics. So whoever changes the code's has to change the model.

Each device function that has such tokens must be in a model or in ci/models/left.def,
with the reason. The model named `response` is that of ci/models/response.py.
"""
import concurrent.futures
import functools
import glob
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../equal"))
import census  # pylint: disable=wrong-import-position
import response  # pylint: disable=wrong-import-position

FOLDER, LEFT = "ci/models", "ci/models/left.def"
# Barriers and fences: what a model has in place of what the code has.
SYNC = {"__syncthreads": "block_sync", "__syncwarp": "warp_sync",
        "__threadfence": "fence", "cluster_sync": "cluster_sync",
        "cluster_sync_shared": "cluster_sync_shared", "group_sync": "cluster_sync",
        "grid_sync": "cluster_sync", "patch_sync": "patch_sync",
        "copies_end": "copies_end", "copies_group": "copies_group",
        "bulk_ask": "bulk_ask", "bulk_wait": "bulk_wait", "bulk_open": "bulk_open"}
LEFT_OUT = ("block_sync", "warp_sync", "fence", "cluster_sync", "cluster_sync_shared",
            "cluster_sync_unless", "cluster_sync_shared_unless", "patch_sync",
            "copies_end", "bulk_wait")
TOGETHER = re.compile(r"\b(__sync\w+|__shfl\w+|__threadfence|__shared__|atomic[A-Z]\w*|"
                      r"cluster_sync(?:_shared)?|group_sync|grid_sync|patch_sync|"
                      r"lane_value|lane_below|warp_sum|cluster_at|copies_\w+|bulk_\w+|"
                      r"volatile int32_t)\b")
NESTED = r"[^()]*(?:\([^()]*\)[^()]*)*"
WORD = (r"(?P<sync>\b(?:" + "|".join(SYNC) + r"))\b(?P<of><\w+>)?"
        rf"\((?P<how>{NESTED})\)|"
        r"(?P<atom>\batomic[A-Z]\w*)\(|"
        r"(?P<shfl>\b__shfl\w+|\blane_value|\bcluster_at|\bvolatile)\b")
SPARE = re.compile(r"spare: ([^*]*[^* ])")


def without_comments(text):
    """A text in which comments are blank, and no line moves."""
    return re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)


@functools.cache
def device():
    """(file, name) to the texts of the device functions of this name."""
    found = {}
    for one in census.functions():
        found.setdefault((one.path, one.name), []).append(one)
    return found


def tokens_of(one):
    """What a device function does with threads and shared memory, in its order."""
    text = re.sub(r"\s+", " ", one.body)
    shared = re.findall(r"__shared__ [^;]*;", text)
    names = [name for line in shared for name in declared(line)]
    for line in shared:
        text = text.replace(line, "")
    access = "|".join(names) or "(?!)"
    found = []
    for m in re.finditer(WORD + rf"|(?P<name>\b(?:{access}))\b(?P<rest>[^;]*)", text):
        found += taken(m, names)
    return found


def declared(line):
    """The names that a declaration of shared memory declares."""
    line = re.sub(r"<[^<>]*>|\[[^\]]*\]", "", line.rstrip(";"))
    return [re.search(r"(\w+)\W*$", part)[1] for part in line.split(",")]


def taken(m, names):
    """The tokens of a match of WORD; those behind a name's first are read again."""
    if m["sync"]:
        how = (m["of"] or "") + (f"({m['how'].strip()})" if m["how"].strip() else "")
        return [m["sync"] + how]
    if m["atom"] or m["shfl"]:
        return [m["atom"] or m["shfl"]]
    found, text = [], m["name"] + m["rest"]
    for part in re.finditer(WORD + rf"|(?P<name>\b(?:{'|'.join(names)}))\b"
                            r"(?P<place>(?:\[[^\[\]]*(?:\[[^\]]*\][^\[\]]*)*\]|\.\w+)*)"
                            r"(?P<set> (?:[-+*/|&]|<<|>>)?=(?!=))?", text):
        if part["name"]:
            found += [w for inner in re.finditer(WORD, part["place"])
                      for w in taken(inner, names)]
            found.append(part["name"] + ("=" if part["set"] else ""))
        else:
            found += taken(part, names)
    return found


def told(tokens):
    """Tokens as a model's comment has them: accesses that repeat are told once."""
    return " ".join(t for k, t in enumerate(tokens) if k == 0 or tokens[k - 1] != t or
                    re.match(r"\w+", t)[0] in SYNC or t.startswith("atomic"))


class Model:
    """A file of ci/models/."""

    def __init__(self, path):
        self.path, self.name = path, os.path.basename(path)[:-4]
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        head = self.text.split("*/")[1]
        self.code = [(file, name, " ".join(words.split())) for file, name, words in
                     re.findall(r"^ \* code (\S+) (\w+):(.*)$", head, re.M)]
        self.faults = []
        self.program = self.planted()

    def planted(self):
        """The program with faults that PLANT chooses."""
        bare = without_comments(self.text).split("\n")
        lines = []
        for line, code in zip(self.text.split("\n"), bare):
            spare = SPARE.search(line)
            if not code.lstrip().startswith(("#define", "inline")):
                code = re.sub(r"\b(" + "|".join(LEFT_OUT) + rf")(\({NESTED}\))",
                              functools.partial(self.plant, spare), code)
                code = re.sub(r"\bFAULT\((\w+)\)", self.named, code)
            lines.append(code)
        return "\n".join(lines)

    def plant(self, spare, m):
        """A barrier or fence that may be left out."""
        count = 1 + sum(fault.startswith(f"without {m[1]} ") for fault, _ in self.faults)
        self.faults.append((f"without {m[1]} {count}", spare[1] if spare else None))
        return f"if :: planted != {len(self.faults)} -> {m[0]} :: else fi"

    def named(self, m):
        """A fault that the model names."""
        self.faults.append((m[1].replace("_", " "), None))
        return f"(planted == {len(self.faults)})"

    def inline(self, name):
        """The model's barriers, fences and atomics in a function of this name."""
        head = re.search(rf"^(?:inline|proctype) {name}\(", self.text, re.M)
        if not head:
            return None
        body = without_comments(self.text[head.end():])
        body = body[:body.find("\n}\n") + 1]
        words = {*SYNC.values(), *LEFT_OUT, "atomic_of"}
        return re.findall(r"\b(" + "|".join(words) + r")\(", body)

    def of_code(self):
        """Whether the functions that it models are still what the code has."""
        results = []
        for file, name, words in self.code:
            bodies = device().get((file, name))
            if not bodies:
                results.append(f"{file} has no {name}")
                continue
            now = [tokens_of(one) for one in bodies]
            if words not in map(told, now):
                results.append(f"{file} {name} is now: {told(now[0])}")
                continue
            code = next(t for t in now if told(t) == words)
            sync = [SYNC.get(re.match(r"\w+", t)[0]) or "atomic_of" for t in code
                    if re.match(r"\w+", t)[0] in SYNC or t.startswith("atomic")]
            own = self.inline(name)
            if own is None and not sync:
                continue
            if own is None:
                results.append(f"it has no inline {name}")
            elif own != of_ranks(sync, code):
                results.append(f"{name}: the code has {of_ranks(sync, code)}, "
                               f"the model {own}")
        return results


def unseen(model):
    """Barriers and fences whose loss from the code `of_code` would not see: none."""
    missed = []
    for file, name, words in model.code:
        for one in device().get((file, name), []):
            for m in re.finditer(WORD, one.body):
                body = one.body[:m.start()] + one.body[m.end():]
                if m["sync"] and told(tokens_of(one)) == words and \
                        told(tokens_of(one._replace(body=body))) == words:
                    missed.append(f"{file} {name} without {m[0]}: not found")
    return missed


def of_ranks(sync, code):
    """A barrier of a cluster that is its block's alone is a block's."""
    words = [t for t in code if re.match(r"\w+", t)[0] in SYNC or t.startswith("atomic")]
    return [s if not word.startswith("cluster_sync") or word.endswith("(false)")
            else "block_sync" if word.endswith("(true)") else s + "_unless"
            for s, word in zip(sync, words)]


def build(model, folder):
    """Compiles Spin's verifier of a model. Returns what failed, or nothing."""
    os.makedirs(folder, exist_ok=True)
    with open(f"{FOLDER}/memory.pml", encoding="utf-8") as file:
        memory = without_comments(file.read())
    program = model.program.replace('#include "memory.pml"', memory)
    with open(f"{folder}/model.pml", "w", encoding="utf-8") as file:
        file.write(program)
    for command in (["spin", "-a", "model.pml"],
                    ["gcc", "-O1", "-w", "-DSAFETY", "-DCOLLAPSE", "-DVECTORSZ=4096",
                     "-DMEMLIM=3000", "-o", "pan", "pan.c"]):
        made = subprocess.run(command, cwd=folder, capture_output=True, text=True,
                              check=False)
        if made.returncode or "Error" in made.stdout:
            return (made.stdout + made.stderr)[-2000:]
    return ""


def verify(folder, plant=0):
    """Runs the verifier: ("holds" | "fault" | "undecided", what it says)."""
    made = subprocess.run(["./pan", "-m1000000", "-w22"], cwd=folder, capture_output=True,
                          text=True, check=False, env={**os.environ, "PLANT": str(plant)})
    said = made.stdout
    wrong = re.search(r"pan:1: (.*?)(?: \(at depth|$)", said, re.M)
    if wrong:
        return "fault", wrong[1].strip()
    if "errors: 0" not in said or "search depth too small" in said or \
            "Search not completed" in said or "reached -DMEMLIM" in said:
        return "undecided", said[-600:] + made.stderr[-600:]
    ends = re.search(r"unreached in proctype thread\n(.*?)(?=\nunreached|\npan)", said,
                     re.S)
    if not plant and not (ends and '"-end-"' not in ends[1]):
        return "undecided", "a process does not reach its end"
    return "holds", (re.search(r"(\S+) states, stored", said) or [0, "?"])[1]


def check(model, build_folder, quick):
    """[(passed, line)] of a model."""
    folder = f"{build_folder}/models/{model.name}"
    results = [(False, f"FAILED {model.name}: {why}")
               for why in model.of_code() + unseen(model)]
    results += [(True, f"ok {model.name}: its code")] if not results else []
    if not shutil.which("spin"):
        return results
    why = build(model, folder)
    if why:
        return results + [(False, f"FAILED {model.name}: {why}")]
    kind, said = verify(folder)
    results.append((kind == "holds", f"proved {model.name}: {said} states"
                    if kind == "holds" else f"FAILED {model.name}: {kind}: {said}"))
    for k, (fault, spare) in enumerate([] if quick else model.faults, 1):
        kind, said = verify(folder, k)
        want = "holds" if spare else "fault"
        results.append((kind == want, f"ok {model.name} {fault}: "
                        f"{'is spare' if spare else 'found: ' + said}" if kind == want
                        else f"FAILED {model.name} {fault}: {kind}, not {want}: {said}"))
    return results


def left():
    """[(file or folder, names or nothing, reason)] of left.def."""
    with open(LEFT, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
    rows = []
    for args in re.findall(r"^LEFT\((.*?)\)$", text, re.M | re.S):
        parts = [part.strip() for part in " ".join(args.split()).split(", ")]
        rows.append((parts[0], parts[2].split() if len(parts) > 2 else [], parts[1]))
    return rows


def coverage(models):
    """[(file, function, the model or None, the reason or None)]."""
    of = {(file, name): model.name for model in models for file, name, _ in model.code}
    rows, found = left(), []
    for (file, name), bodies in device().items():
        if any(TOGETHER.search(one.body) for one in bodies):
            why = next((why for where, names, why in rows if file.startswith(where)
                        and (not names or name in names)), None)
            found.append((file, name, of.get((file, name)), why))
    return found


def table():
    """The table of spec/proofs.md: which model has which functions, and what is left."""
    models, rows, why_left = every_model(), [], {}
    found = coverage(models)
    for model in models:
        files = {}
        for file, name, _ in model.code:
            files.setdefault(file, []).append(f"`{name}`")
        what = "; ".join(f"{file}: {', '.join(names)}" for file, names in files.items())
        faults = sum(not spare for _, spare in model.faults)
        rows.append(f"| {model.name}.pml | {what} | {faults} |")
    for file, name, model, why in found:
        if not model:
            why_left.setdefault(why or "no model yet", {}).setdefault(file, []).append(name)
    had = sum(model is not None for _, _, model, _ in found)
    lines = [f"Models have {had} of the {len(found)} device functions in which threads "
             f"work together.", "", "| model | code | faults that it finds |",
             "| --- | --- | ---: |", *rows, "", "| why there is no model | functions |",
             "| --- | --- |"]
    for why, files in sorted(why_left.items()):
        what = "; ".join(f"{file}: {', '.join(f'`{name}`' for name in names)}"
                         for file, names in files.items())
        lines.append(f"| {why} | {what} |")
    return "\n".join(lines)


def every_model():
    """The models of ci/models/."""
    return [Model(path) for path in sorted(glob.glob(f"{FOLDER}/*.pml"))
            if not path.endswith("/memory.pml")]


def main(build_folder, *options):
    """Checks the models, or those that are named."""
    quick = "--quick" in options
    names = [name for name in options if not name.startswith("--")]
    models = every_model()
    if "--code" in options:
        for (file, name), bodies in device().items():
            if any(TOGETHER.search(one.body) for one in bodies):
                print(f" * code {file} {name}: {told(tokens_of(bodies[0]))}")
        return 0
    results = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        chosen = [m for m in models if not names or m.name in names]
        for lines in pool.map(lambda m: check(m, build_folder, quick), chosen):
            for passed, line in lines:
                print(line, flush=True)
                results.append(passed)
    for passed, line in response.check(build_folder, quick) if not names or \
            "response" in names else []:
        print(line, flush=True)
        results.append(passed)
    for file, name, model, why in coverage(models) if not names else []:
        if not model and not why:
            print(f"FAILED {LEFT}: neither a model nor a reason for {file} {name}")
            results.append(False)
    skipped = not shutil.which("spin")
    if skipped:
        print("skipped: models: spin is not installed (sh ci/deps.sh installs it)")
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed, "
          f"{int(skipped)} skipped")
    return 0 if results and all(results) else 1


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
    sys.exit(main(*sys.argv[1:]))
