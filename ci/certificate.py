#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The certificate: what of it has to run, how it is written, and its check.

usage: ci/certificate.py plan WORK OLD BUILD  says what the certificate OLD keeps;
                                              what has to run: WORK/stages,
                                              WORK/scenes, WORK/TOOL
       ci/certificate.py write WORK FILE      from WORK/rows and what is kept
       ci/certificate.py prune FILE           leaves out what no longer holds, where
                                              no device can be had
       ci/certificate.py check FILE BUILD     ends with N passed, N failed
       ci/certificate.py line FILE            one line for `drape info`

A row holds a digest (`code`) of all that it depends on. A stage's row depends on
the sources that the linker and the compiler needed for ref_X and gpu_X
(`sources`), on the flags, and on the golden hashes, which change where generated
cases do. A scene's row depends on all code of spec/, ref/ and gpu/, on the flags,
on its line of ci/scenes.certified, on its file and on the patterns that it names.
Where that digest, the device, the toolkit and the driver are still the same, a new
certificate keeps the row; `run` says which run of ci/certify.sh the row is from.
"""
import functools
import glob
import hashlib
import json
import os
import re
import subprocess
import sys

import tree

FIELDS = {
    "stage": ("stage", "bits", "cases", "mismatches", "digest"),
    "scene": ("scene", "what", "steps", "traced", "stages", "mismatches",
              "digest", "first6"),
    "sanitizer": ("tool", "stage", "status")}
NUMBERS = ("bits", "cases", "mismatches", "steps", "traced", "stages", "status")
KINDS = tuple(FIELDS)
TOOLS = ("memcheck", "racecheck", "initcheck", "synccheck")
AGAIN = ("gpu again, block 0", "gpu again, block 64", "gpu again, block 96",
         "after a checkpoint")
FUSED = "fused"  # the substeps of gpu/cloth/explicit.cu, by a test
FEW = 8  # rows that are skipped by name; more are counted
MACHINE = ("device", "toolkit", "driver")


def sha(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def stages():
    return re.findall(r"^STAGE\(\w+, \w+, (\w+),", read("spec/stages.def"), re.M)


def golden():
    return {(name, int(bits)): digest for name, bits, digest in
            (line.split() for line in open("tests/golden/stages.txt"))}


def scenes(path="ci/scenes.certified"):
    """Name to frames, traced, file, also, and the line itself."""
    found = {}
    for line in read(path).splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        name, file, frames, _, also, *keys = line.split(None, 5)
        part = [int(n) for n in frames.split("-")]
        found[name] = {
            "file": file, "frames": part[-1], "keys": "".join(keys),
            "also": also, "traced": part[0] + part[-1] - part[-2]
            if len(part) > 1 else part[0]}
    return found


def wanted():
    """The rows that a certificate must have, by kind."""
    rows = {"stage": list(golden()), "scene": [], "sanitizer": []}
    for name, scene in scenes().items():
        rows["scene"].append((name, "ref and gpu"))
        if scene["also"] == "again":
            rows["scene"] += [(name, what) for what in AGAIN]
    for tool in TOOLS:
        rows["sanitizer"] += [(tool, name) for name in stages() + [FUSED]]
    return rows


def symbols(objects):
    """Object to names it needs; name to objects that define it."""
    needs, defines = {}, {}
    out = subprocess.run(["nm", "-P", "-g", "-A"] + objects, check=True,
                         stdout=subprocess.PIPE, universal_newlines=True).stdout
    for line in out.splitlines():
        name, rest = line.split(": ", 1)
        symbol, kind = rest.split()[:2]
        if kind in "Uwv":
            needs.setdefault(name, set()).add(symbol)
        else:
            defines.setdefault(symbol, set()).add(name)
    return needs, defines


def compiled(name):
    """The files of ours that an object was compiled of: its .d says."""
    rule = read(name[:-2] + ".d").replace("\\\n", " ").split("\n")[0]
    words = map(os.path.normpath, rule.split(":", 1)[1].split())
    return {word for word in words
            if word.startswith(("spec/", "ref/", "gpu/"))}


def linked(build, kernels):
    """What sources() gives, for the kernels' objects of that folder."""
    objects = glob.glob(f"{build}/ref/*/*.o") + glob.glob(f"{kernels}/*/*.o")
    needs, defines = symbols(objects)
    roots = {FUSED: {name for name in objects
                     if "/cloth/explicit." in name}}
    for stage in stages():
        names = [f"{side}_{stage}_{bits}" for side in ("ref", "gpu")
                 for bits in (32, 64)]
        if not all(name in defines for name in names):
            return {}
        roots[stage] = set().union(*(defines[name] for name in names))
    found = {}
    for stage, seen in roots.items():
        todo = list(seen)
        while todo:
            for symbol in needs.get(todo.pop(), ()):
                for name in defines.get(symbol, set()) - seen:
                    seen.add(name)
                    todo.append(name)
        files = set().union(*(compiled(name) for name in seen))
        found[stage] = " ".join(sorted(files))
    return found


def sources(build):
    """Stage to the sources of all that ref_X and gpu_X may call, by what the
    linker needs and the compiler read; of the emulated kernels where CUDA's are
    not all built."""
    found = linked(build, f"{build}/cuda/gpu") or linked(build, f"{build}/gpu")
    if not found:
        sys.exit(f"{build} does not have the objects of every stage")
    return found


@functools.lru_cache(maxsize=None)
def tokens(text):
    return hashlib.sha256(tree.code(text).encode()).hexdigest()


def code_of_stage(stage, files):
    text = [tree.digest("flags")]
    text += [f"{digest} {bits}" for (name, bits), digest
             in sorted(golden().items()) if name == stage]
    for name in files.split():
        text.append(f"{name} " + (tokens(read(name))
                                  if os.path.exists(name) else "gone"))
    return sha("\n".join(text))


def trees():
    return {part: tree.digest(part) for part in ("spec", "ref", "gpu", "flags")}


def text_of_scene(name):
    """A scene's file, and the patterns that it names."""
    path = os.path.join("app/scenes", f"{name}.json")
    text = read(path)
    patterns = sorted(set(re.findall(r'"pattern": "([^"]*)"', text)))
    return text + "".join(read(os.path.join(os.path.dirname(path), name))
                          for name in patterns)


def codes(files):
    """What each row depends on now; files: sources of each stage."""
    whole = json.dumps(trees())
    found = {}
    for stage in stages() + [FUSED]:
        if stage in files:
            found["stage", stage] = code_of_stage(stage, files[stage])
    for name, scene in scenes().items():
        found["scene", name] = sha(whole + json.dumps(scene) + " ".join(
            text_of_scene(scene["file"]).split()))
    return found


def key(kind, row):
    """Where codes() has what a row depends on."""
    return ("scene", row["scene"]) if kind == "scene" else (
        "stage", row["stage"])


def name_of(kind, row):
    return tuple(row[field] for field in FIELDS[kind][:2])


def fine(kind, row):
    if kind == "stage":
        return not row["mismatches"] and row["cases"] > 0
    if kind == "sanitizer":
        return not row["status"]
    scene = scenes().get(row["scene"], {"frames": 0, "traced": 0})
    return not row["mismatches"] and row["stages"] > 0 and (
        row["what"] != "ref and gpu" or
        (row["steps"] >= scene["frames"] and row["traced"] >= scene["traced"]))


def rows_of(work):
    """Fields of this run, and rows by kind."""
    run, rows = {}, {kind: [] for kind in KINDS}
    for line in open(f"{work}/rows"):
        kind, *field = line.rstrip("\n").split("\t")
        if kind not in rows:
            run[kind] = field[0]
            continue
        row = dict(zip(FIELDS[kind], field))
        for name in NUMBERS:
            if name in row:
                row[name] = int(row[name])
        rows[kind].append(row)
    return run, rows


def kept(old, run, now):
    """The rows of a certificate that still hold on this machine."""
    rows = {kind: [] for kind in KINDS}
    for kind in KINDS:
        for row in old.get(kind + "s", []):
            at = old["runs"][row["run"]]
            if (all(at[name] == run[name] for name in MACHINE) and
                    name_of(kind, row) in wanted()[kind] and fine(kind, row) and
                    row["code"] == now.get(key(kind, row))):
                rows[kind].append(dict(row, run=at))
    # a scene runs as a whole, and so do a stage's two precisions
    for kind in ("scene", "stage"):
        have = {name_of(kind, row) for row in rows[kind]}
        lost = {name[0] for name in wanted()[kind] if name not in have}
        rows[kind] = [r for r in rows[kind] if r[FIELDS[kind][0]] not in lost]
    return rows


def plan(work, path, build):
    run, _ = rows_of(work)
    files = sources(build)
    now = codes(files)
    old = json.load(open(path)) if os.path.exists(path) else {}
    rows = kept(old if "runs" in old else {}, run, now)
    with open(f"{work}/kept.json", "w") as file:
        json.dump({"rows": rows, "sources": files,
                   "codes": {" ".join(at): code for at, code in now.items()}},
                  file)
    for kind, column, targets in (("stage", 0, ["stages"]),
                                  ("scene", 0, ["scenes"]),
                                  ("sanitizer", 1, TOOLS)):
        have = {name_of(kind, row) for row in rows[kind]}
        left = [n for n in wanted()[kind] if n not in have]
        for target in targets:
            names = [n[column] for n in left
                     if column == 0 or n[0] == target]
            with open(f"{work}/{target}", "w") as file:
                file.write("".join(f"{n}\n" for n in dict.fromkeys(names)))
            print(f"{target}: {len(dict.fromkeys(names))} run",
                  *list(dict.fromkeys(names))[:6], "..." if names[6:] else "")
        print(f"{kind}s: {len(have)} rows are kept")


def write(work, path):
    run, rows = rows_of(work)
    plan_ = json.load(open(f"{work}/kept.json"))
    runs = [run] if any(rows.values()) else []  # the newest is the first
    out = {"trees": trees(), "runs": runs}
    for kind in KINDS:
        for row in rows[kind]:
            row["code"] = plan_["codes"][" ".join(key(kind, row))]
            row["run"] = run
        order = wanted()[kind]
        all_rows = [r for r in plan_["rows"][kind] + rows[kind]
                    if name_of(kind, r) in order]
        all_rows.sort(key=lambda row: order.index(name_of(kind, row)))
        for row in all_rows:
            if row["run"] not in runs:
                runs.append(row["run"])
            row["run"] = runs.index(row["run"])
        out[kind + "s"] = all_rows
    out["sources"] = plan_["sources"]
    put(out, path)


def put(out, path):
    text = json.dumps(out, indent=1)
    # a row a line, so that the difference of two certificates reads well
    text = re.sub(r"\{\n +([^{}\[\]]*?)\n +\}",
                  lambda found: "{" + " ".join(found[1].split()) + "}"
                  if '"sum": "' not in found[1] else found[0], text)
    with open(path, "w") as file:
        file.write(text + "\n")


def prune(path):
    out = json.load(open(path))
    now, runs = codes(out["sources"]), []
    for kind in KINDS:
        out[kind + "s"] = [row for row in out[kind + "s"]
                           if row["code"] == now.get(key(kind, row))]
        for row in out[kind + "s"]:
            run = out["runs"][row["run"]]
            if run not in runs:
                runs.append(run)
            row["run"] = runs.index(run)
    out.update(trees=trees(), runs=runs)
    put(out, path)


def stale(certificate):
    """What the tree has become another of since: folders, flags, rows."""
    files = certificate.get("sources", {})
    now, found = codes(files), []
    for kind in KINDS:
        found += [f"{kind} {key(kind, row)[1]}" for row
                  in certificate[kind + "s"]
                  if row["code"] != now.get(key(kind, row))]
    parts = [part for part, digest in trees().items()
             if certificate["trees"].get(part) != digest]
    return parts + list(dict.fromkeys(found))


def unequal(certificate):
    """What was found not to be equal, or not to be clean."""
    return [f"{kind} {', '.join(map(str, name_of(kind, row)))}"
            for kind in KINDS for row in certificate.get(kind + "s", [])
            if not fine(kind, row)]


def missing(certificate):
    """What no device has run yet."""
    found, want = [], wanted()
    for kind in KINDS:
        have = {name_of(kind, row) for row in certificate.get(kind + "s", [])}
        found += [f"{kind} {', '.join(map(str, name))} is missing"
                  for name in want[kind] if name not in have]
    return found


def faults(certificate):
    """All that a certificate must not say, or must not leave out."""
    return unequal(certificate) + missing(certificate)


def incomplete(files):
    """Stages of which no source has the stage's own function, on either side."""
    found = []
    for stage in stages():
        have = files.get(stage, "").split()
        for name, end in ((f"ref_{stage}(", ".c"), (f"gpu_{stage}(", ".cu")):
            if not any(path.endswith(end) and os.path.exists(path) and
                       name in read(path) for path in have):
                found.append(f"the sources of stage {stage} lack {name})")
    return found


def first_steps(build, scene):
    """Digest of the reference's first six steps, computed here and now."""
    text = read(f"app/scenes/{scene['file']}.json")
    run = os.path.join(build, "certificate")
    os.makedirs(run, exist_ok=True)
    path = os.path.join(run, "scene.json")
    with open(path, "w") as file:
        file.write(text.replace("{", "{" + scene["keys"], 1))
    subprocess.run([f"{build}/drape", "run", path, "--backend", "ref",
                    "--trace", "--no-obj", "--frames", "6", "--out", run,
                    "--force"],
                   check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    lines = [",".join(line.split(",")[:3]) + "\n"
             for line in open(os.path.join(run, "trace.csv"))]
    return sha("".join(lines))


def reference():
    """Digests of scenes by ref/, of whatever tree that was."""
    if not os.path.exists("ci/reference.txt"):
        return {}
    rows = (line.split() for line in open("ci/reference.txt"))
    return {name: digest for name, _, digest in rows}


def unlike(certificate, known):
    """Scenes and stages whose digests are not the reference's."""
    want = golden()
    return [f"scene {r['scene']}: other bits than the reference's"
            for r in certificate["scenes"] if r["what"] == "ref and gpu" and
            known.get(r["scene"], r["digest"]) != r["digest"]] + [
        f"stage {r['stage']}, {r['bits']} bits: other bits than the reference's"
        for r in certificate["stages"]
        if want.get((r["stage"], r["bits"])) != r["digest"]]


def check(path, build):
    certificate = json.load(open(path))
    if "runs" not in certificate:
        print("FAILED certificate: it is of an older kind\n0 passed, 1 failed")
        return 1
    failed = [f"{part} changed since" for part in stale(certificate)]
    failed += [f"it records: {what}" for what in unequal(certificate)]
    left = missing(certificate)
    failed += incomplete(certificate["sources"])
    failed += unlike(certificate, reference())
    passed = sum(map(len, wanted().values())) - len(left)
    for name, scene in scenes().items():
        if scene["file"] != "tiny":
            continue
        row = [r for r in certificate["scenes"] if r["scene"] == name]
        if row and row[0]["first6"] != first_steps(build, scene):
            failed.append(f"scene {name}: other bits than the reference's")
        passed += bool(row)
    for what in failed:
        print(f"FAILED certificate: {what}")
    for kind in KINDS:
        rows = [what for what in left if what.startswith(kind)]
        if len(rows) > FEW:
            rows = [f"{len(rows)} rows of {kind}s"]
        for what in rows:
            print(f"skipped: {what.removesuffix(' is missing')}: no device has "
                  "run it yet")
    print(f"{max(passed - len(failed), 0)} passed, {len(failed)} failed" +
          (f", {len(left)} skipped" if left else ""))
    return 1 if failed else 0


def line(path):
    if not os.path.exists(path):
        return "NOT CERTIFIED (no GPU has been compared)"
    certificate = json.load(open(path))
    if "runs" not in certificate:
        return "NOT CERTIFIED (a certificate of an older kind)"
    found = faults(certificate)
    if found:
        return f"NOT CERTIFIED ({found[0]})"
    changed = stale(certificate)
    if changed:
        return f"NOT CERTIFIED ({', '.join(changed[:4])} changed since)"
    newest = certificate["runs"][0]
    older = sum(row["run"] > 0 for kind in KINDS
                for row in certificate[kind + "s"])
    words = [newest["device"], newest["date"], newest["commit"]]
    words += [f"{older} rows kept from before"] if older else []
    return ", ".join(word for word in words if word)


if __name__ == "__main__":
    if sys.argv[1:2] == ["plan"] and len(sys.argv) == 5:
        plan(*sys.argv[2:])
    elif sys.argv[1:2] == ["write"] and len(sys.argv) == 4:
        write(*sys.argv[2:])
    elif sys.argv[1:2] == ["prune"] and len(sys.argv) == 3:
        prune(sys.argv[2])
    elif sys.argv[1:2] == ["check"] and len(sys.argv) == 4:
        sys.exit(check(sys.argv[2], sys.argv[3]))
    elif sys.argv[1:2] == ["line"] and len(sys.argv) == 3:
        print(line(sys.argv[2]))
    else:
        sys.exit(__doc__)
