#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The certificate: written from the rows of ci/certify.sh, and checked.

usage: ci/certificate.py write ROWS FILE
       ci/certificate.py check FILE BUILD   what holds it up; N passed, N failed
       ci/certificate.py line FILE          one line for `drape info`
"""
import hashlib
import json
import os
import subprocess
import sys
import time

import tree

SCENE = ("scene", "what", "steps", "traced", "stages", "mismatches", "digest",
         "first6")
STAGE = ("stage", "bits", "cases", "mismatches", "digest")
TRACED = 12  # of a scene's steps, if it has as many
TOOLS = {"memcheck", "racecheck", "initcheck", "synccheck"}
# Of each scene, the steps that are to be compared at least.
SCENES = {"tiny": 6, "tiny64": 6, "lion_20k_baraff-witkin": 120,
          "lion_20k_choi-ko": 120, "lion_20k_euler": 24,
          "lion_20k_midpoint": 24, "lion_20k_verlet": 24,
          "lion_20k_rk4": 24, "lion_20k_64": 30, "lion_20k_jacobi": 30,
          "funnel": 20, "twist": 20, "curtain": 20, "flag": 20, "thrown": 8,
          "buddha_500k": 10, "buddha_500k_jacobi": 3, "buddha_2m": 3}
AGAIN = {"gpu again, block 0", "gpu again, block 64", "gpu again, block 96",
         "after a checkpoint", "as graphs"}
WANTED = {(scene, "ref and gpu") for scene in SCENES} | {
    ("lion_20k_baraff-witkin", what) for what in AGAIN} | {
    (scene, "as graphs") for scene in ("lion_20k_choi-ko", "funnel", "twist")}


def number(text):
    return int(text) if text.lstrip("-").isdigit() and len(text) < 12 else text


def write(rows, path):
    out = {"date": time.strftime("%Y-%m-%d", time.gmtime()), "trees": {},
           "stages": [], "scenes": [], "sanitizers": []}
    for line in open(rows):
        kind, *field = line.rstrip("\n").split("\t")
        if kind == "tree":
            out["trees"][field[0]] = field[1]
        elif kind == "stage":
            out["stages"].append(dict(zip(STAGE, field)))
        elif kind == "scene":
            out["scenes"].append(dict(zip(SCENE, field)))
        elif kind == "sanitizer":
            out["sanitizers"].append(
                dict(zip(("tool", "status", "summary"), field)))
        else:
            out[kind] = field[0]
    for row in out["stages"] + out["scenes"] + out["sanitizers"]:
        for key in ("bits", "cases", "mismatches", "steps", "traced", "stages",
                    "status"):
            if key in row:
                row[key] = number(row[key])
    with open(path, "w") as file:
        json.dump(out, file, indent=1)
        file.write("\n")


def stale(certificate):
    """Folders whose code has changed since, and the compiler's flags."""
    return [part for part in ("spec", "ref", "gpu", "flags")
            if certificate["trees"].get(part) != tree.digest(part)]


def golden():
    return {(name, int(bits)): digest for name, bits, digest in
            (line.split() for line in open("tests/golden/stages.txt"))}


def too_few(row):
    wanted = SCENES.get(row["scene"], 0)
    return row["steps"] < wanted or row["traced"] < min(wanted, TRACED)


def faults(certificate):
    """What was found not to be equal, not to be clean, or not at all."""
    found = [f"stage {r['stage']}, {r['bits']} bits"
             for r in certificate["stages"]
             if r["mismatches"] or not r["cases"]]
    found += [f"scene {r['scene']}, {r['what']}"
              for r in certificate["scenes"] if r["mismatches"]]
    found += [f"scene {r['scene']}: {r['steps']} steps, {r['traced']} traced"
              for r in certificate["scenes"] if r["what"] == "ref and gpu"
              and too_few(r)]
    found += [r["tool"] for r in certificate["sanitizers"] if r["status"]]
    scenes = {(r["scene"], r["what"]) for r in certificate["scenes"]
              if r["stages"] or (r["what"] == "as graphs" and
                                 r["steps"] >= SCENES[r["scene"]])}
    stages = {(r["stage"], r["bits"]) for r in certificate["stages"]}
    missing = [f"scene {name}, {what}" for name, what in WANTED - scenes]
    missing += [f"stage {name}, {bits} bits"
                for name, bits in golden().keys() - stages]
    missing += TOOLS - {r["tool"] for r in certificate["sanitizers"]}
    return found + [f"{what} is missing" for what in sorted(missing)]


def first_steps(build, scene, keys):
    """Digest of the reference's first six steps, computed here and now."""
    text = open(f"app/scenes/{scene}.json").read().replace("{", "{" + keys, 1)
    run = os.path.join(build, "certificate")
    os.makedirs(run, exist_ok=True)
    path = os.path.join(run, "scene.json")
    with open(path, "w") as file:
        file.write(text)
    subprocess.run([f"{build}/drape", "run", path, "--backend", "ref",
                    "--trace", "--no-obj", "--frames", "6", "--out", run,
                    "--force"],
                   check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    lines = [",".join(line.split(",")[:3]) + "\n"
             for line in open(os.path.join(run, "trace.csv"))]
    return hashlib.sha256("".join(lines).encode()).hexdigest()[:16]


def reference():
    """Digests of scenes by ref/, of whatever tree that was."""
    if not os.path.exists("ci/reference.txt"):
        return {}
    rows = (line.split() for line in open("ci/reference.txt"))
    return {name: digest for name, key, digest in rows}


def unlike(certificate, known):
    """Scenes whose digests are not the reference's."""
    return [f"scene {r['scene']}: other bits than the reference's"
            for r in certificate["scenes"] if r["what"] == "ref and gpu" and
            known.get(r["scene"], r["digest"]) != r["digest"]]


def check(path, build):
    certificate = json.load(open(path))
    failed = [f"{part} changed since" for part in stale(certificate)]
    failed += [f"it records: {what}" for what in faults(certificate)]
    failed += unlike(certificate, reference())
    want = golden()
    got = {(r["stage"], r["bits"]): r["digest"] for r in certificate["stages"]}
    failed += [f"stage {name}, {bits} bits: other bits than the reference's"
               for (name, bits), digest in want.items()
               if got.get((name, bits)) != digest]
    passed = len(want)
    for name, keys in (("tiny", ""), ("tiny64", '"precision": 64,')):
        row = [r for r in certificate["scenes"] if r["scene"] == name]
        if not row or row[0]["first6"] != first_steps(build, "tiny", keys):
            failed.append(f"scene {name}: other bits than the reference's")
        passed += 1
    for what in failed:
        print(f"FAILED certificate: {what}")
    print(f"{max(passed - len(failed), 0)} passed, {len(failed)} failed")
    return 1 if failed else 0


def line(path):
    if not os.path.exists(path):
        return "NOT CERTIFIED (no GPU has been compared)"
    certificate = json.load(open(path))
    if faults(certificate):
        return f"NOT CERTIFIED ({faults(certificate)[0]})"
    changed = stale(certificate)
    if changed:
        return f"NOT CERTIFIED ({', '.join(changed)} changed since)"
    return f"{certificate['device']}, {certificate['date']}"


if __name__ == "__main__":
    if sys.argv[1:2] == ["write"] and len(sys.argv) == 4:
        write(sys.argv[2], sys.argv[3])
    elif sys.argv[1:2] == ["check"] and len(sys.argv) == 4:
        sys.exit(check(sys.argv[2], sys.argv[3]))
    elif sys.argv[1:2] == ["line"] and len(sys.argv) == 3:
        print(line(sys.argv[2]))
    else:
        sys.exit(__doc__)
