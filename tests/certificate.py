# SPDX-License-Identifier: Apache-2.0
"""Whether ci/certificate.py refuses a certificate that lacks something or is of
other code, and keeps the rows whose code is the same, and no others.

usage: tests/certificate.py BUILD; ends with `N passed, N failed`. A complete
certificate is made up for a copy of the tree, and each fault is planted in a copy
of the certificate or in a file of that tree.
"""
import copy
import json
import os
import re
import shutil
import sys
import tempfile

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "ci"))
import certificate  # noqa: E402: it lies in ci/

counts = [0, 0]
RUN = {"date": "2000-01-01", "commit": "c0ffee", "device": "a device",
       "toolkit": "13.0", "driver": "580"}


def check(name, good):
    counts[not good] += 1
    if not good:
        print("not ok " + name)


def made_up():
    """A certificate of this tree, with all that is asked for."""
    files = {certificate.FUSED: "gpu/cloth/explicit.cu"}
    for room, file, stage in re.findall(
            r"STAGE\((\w+), (\w+), (\w+),", open("spec/stages.def").read()):
        files[stage] = (f"gpu/{room}/{file}.cu ref/{room}/{file}.c "
                        f"ref/{room}/{file}.h spec/stages.def")
    now, out = certificate.codes(files), {
        "trees": certificate.trees(), "runs": [dict(RUN)], "sources": files}
    for kind in certificate.KINDS:
        out[kind + "s"] = []
        for name in certificate.wanted()[kind]:
            row = dict(zip(certificate.FIELDS[kind], name), mismatches=0, run=0,
                       cases=3, status=0, digest="")
            if kind == "scene":
                scene = certificate.scenes()[name[0]]
                row.update(steps=scene["frames"], traced=scene["traced"],
                           stages=9, digest=name[0])
            if kind == "stage":
                row["digest"] = certificate.golden()[name]
            row["code"] = now[certificate.key(kind, row)]
            out[kind + "s"].append(row)
    return out


def planted(name, part, key, value, row=0):
    """One row of a part has another value, or is not there if key is None."""
    faulty = copy.deepcopy(whole)
    if key is None:
        del faulty[part][row]
    else:
        faulty[part][row][key] = value
    check(f"{part}: {name}", len(certificate.faults(faulty)) == 1)


def keeps(run=None):
    """The names of the rows that a new certificate keeps, by kind."""
    rows = certificate.kept(copy.deepcopy(whole), run or RUN,
                            certificate.codes(whole["sources"]))
    return {kind: [certificate.name_of(kind, row) for row in rows[kind]]
            for kind in rows}


def edited(path, old, new, stale, lost):
    """A file has other text: the parts and rows that are stale then, and the
    rows that are lost: of all kinds, or a number of them by kind."""
    text = open(path, encoding="utf-8").read()
    assert old in text, f"{path}: {old}"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(old, new, 1))
    title = f"{path}: {old!r} becomes {new!r}"
    found = certificate.stale(whole)
    check(f"{title}: stale: {found[:5]}", stale(found))
    check(f"{title}: not refused", not found or certificate.line(
        "certificate.json").startswith("NOT CERTIFIED"))
    have = keeps()
    gone = {kind: len(certificate.wanted()[kind]) - len(have[kind])
            for kind in have}
    check(f"{title}: lost {gone}", gone == lost)
    certificate.put(whole, "pruned.json")
    certificate.prune("pruned.json")
    with open("pruned.json", encoding="utf-8") as file:
        pruned = json.load(file)
    left = {kind: [certificate.name_of(kind, row) for row in pruned[kind + "s"]]
            for kind in have}
    check(f"{title}: pruned of more or less than is stale",
          left == have and not certificate.stale(pruned))
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def trial(build):
    """Every planted fault, in a copy of the tree that is current."""
    check("nothing is wrong with all", not certificate.faults(whole))
    check("nothing is stale", not certificate.stale(whole))
    check("it says so", certificate.line("certificate.json") ==
          "a device, 2000-01-01, c0ffee")
    everything = certificate.wanted()
    check("all is kept", keeps() == everything)
    for name in certificate.MACHINE:
        check(f"another {name}: nothing is kept",
              not any(keeps(dict(RUN, **{name: "other"})).values()))
    less = dict(whole, sanitizers=[])
    check("what is left to run is no fault of what ran", not certificate.unequal(
        less) and len(certificate.missing(less)) == len(whole["sanitizers"]))
    for k, scene in enumerate(whole["scenes"]):
        title = f"{scene['scene']}, {scene['what']}"
        planted(f"{title}: left out", "scenes", None, 0, k)
        planted(f"{title}: a difference", "scenes", "mismatches", 1, k)
        planted(f"{title}: no stage", "scenes", "stages", 0, k)
        if scene["what"] == "ref and gpu":
            planted(f"{title}: a step less", "scenes", "steps",
                    scene["steps"] - 1, k)
            planted(f"{title}: hardly traced", "scenes", "traced", 2, k)
    planted("left out", "stages", None, 0)
    planted("a difference", "stages", "mismatches", 1)
    planted("no case", "stages", "cases", 0)
    planted("left out", "sanitizers", None, 0)
    planted("a finding", "sanitizers", "status", 1)
    known = {name: name for name in certificate.scenes()}
    check("digests are the reference's", not certificate.unlike(whole, known))
    check("one is not", len(certificate.unlike(whole, {"flag": "0"})) == 1)

    # What leaves all as it is, and what does not.
    none = {"stage": 0, "scene": 0, "sanitizer": 0}
    every = {kind: len(rows) for kind, rows in everything.items()}
    scenes = dict(none, scene=every["scene"])
    one = {"stage": 2, "scene": every["scene"], "sanitizer": 4}
    home, page = "ref/contact/impulses.c", "spec/contact/impulses.md"
    edited(home, "/* ", "/* Another comment. ", lambda found: not found, none)
    edited(page, "\n", " other words\n", lambda found: not found, none)
    edited(home, " + ", " - ", lambda found: "ref" in found and
           "stage impulses" in found and "stage springs" not in found and
           "scene tiny" in found, one)
    edited("gpu/contact/impulses.cu", " < ", " <= ", lambda found:
           "gpu" in found and "stage impulses" in found, one)
    edited("ref/world/step.c", "(", "((", lambda found:
           "ref" in found and not any("stage" in name for name in found), scenes)
    edited("gpu/cloth/explicit.cu", "(struct", "((struct", lambda found:
           "sanitizer fused" in found, dict(scenes, sanitizer=4))
    edited("Makefile", "-ffp-contract=off", "-ffp-contract=fast", lambda found:
           "flags" in found and "stage sum" in found, every)
    golden = open("tests/golden/stages.txt").readline().strip()
    stage = golden.split()[0]
    edited("tests/golden/stages.txt", golden, golden[:-1] + "x", lambda found:
           f"stage {stage}" in found, dict(none, stage=2, sanitizer=4))
    edited("ci/scenes.certified", '"gravity": [0, -900, 0]',
           '"gravity": [0, -901, 0]', lambda found:
           found == ["scene thrown"], dict(none, scene=1))
    edited("app/scenes/flag.json", "1", "2", lambda found:
           found == ["scene flag"], dict(none, scene=1))
    edited("app/patterns/tee.json", "26", "27", lambda found:
           found == ["scene panels", "scene sewn"], dict(none, scene=2))

    # A row that is carried over although its code is not what it was.
    forged = copy.deepcopy(whole)
    forged["stages"][0]["code"] = "0" * 16
    check("a row of other code is refused", certificate.stale(forged) ==
          ["stage " + forged["stages"][0]["stage"]])
    forged = copy.deepcopy(whole)
    forged["sources"]["impulses"] = "spec/stages.def"
    check("sources left out are refused", any(
        "impulses" in what for what in certificate.incomplete(
            forged["sources"])) and "stage impulses" in certificate.stale(forged))
    lines = open("ci/scenes.certified").read()
    with open("ci/scenes.certified", "a") as file:
        file.write("another tiny 6 f8 -\n")
    check("a scene that is missing is refused", certificate.faults(whole) ==
          ["scene another, ref and gpu is missing"])
    with open("ci/scenes.certified", "w") as file:
        file.write(lines)

    # A certificate made of kept rows and rows of this run.
    os.mkdir("work")
    other = {**RUN, "date": "2000-02-02", "commit": "beef"}
    with open("work/rows", "w") as file:
        file.writelines(f"{name}\t{value}\n" for name, value in other.items())
        row = [r for r in whole["scenes"] if r["scene"] == "flag"][0]
        file.write("\t".join(["scene"] + [str(row.get(name, "")) for name in
                                          certificate.FIELDS["scene"]]) + "\n")
    with open("work/kept.json", "w") as file:
        rows = {kind: [dict(row, run=RUN) for row in whole[kind + "s"]
                       if row.get("scene") != "flag"]
                for kind in certificate.KINDS}
        certificate.json.dump({"rows": rows, "sources": whole["sources"],
                               "codes": {" ".join(at): code for at, code in
                                         certificate.codes(
                                             whole["sources"]).items()}}, file)
    certificate.write("work", "new.json")
    new = certificate.json.load(open("new.json"))
    runs = {row["scene"]: new["runs"][row["run"]] for row in new["scenes"]}
    kept = sum(every.values()) - 1
    check("rows say which run they are from", runs["flag"] == other and
          runs["tiny"] == RUN)
    check("the line says what is kept", certificate.line("new.json") ==
          f"a device, 2000-02-02, beef, {kept} rows kept from before")

    # The sources that the linker and the compiler needed.
    files = certificate.sources(build)
    check("each stage has its own", not certificate.incomplete(files))
    check("who is called is there", all(
        name in files["pcg"].split() for name in
        ("ref/solve/multigrid.c", "gpu/solve/multigrid.cu", "ref/solve/pcg.c",
         "gpu/solve/pcg.cu", "ref/base/real.h")))
    check("who is not is not", "ref/contact/impulses.c" not in files["springs"])
    check("all exist", all(os.path.exists(name) for text in files.values()
                           for name in text.split()))


build = os.path.abspath(sys.argv[1])
with tempfile.TemporaryDirectory() as copied:
    for name in ("spec", "ref", "gpu", "ci", "app/scenes", "app/patterns",
                 "tests/golden"):
        shutil.copytree(os.path.join(root, name), os.path.join(copied, name))
    shutil.copy(os.path.join(root, "Makefile"), copied)
    os.chdir(copied)
    whole = made_up()
    with open("certificate.json", "w") as file:
        certificate.json.dump(whole, file)
    trial(build)
    os.chdir(root)
print(f"{counts[0]} passed, {counts[1]} failed")
sys.exit(counts[1] > 0)
