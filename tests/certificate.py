# SPDX-License-Identifier: Apache-2.0
"""Whether ci/certificate.py refuses what a certificate may lack.

usage: tests/certificate.py; ends with `N passed, N failed`. A certificate that
has all is made up, and each fault planted in a copy of it.
"""
import copy
import os
import sys

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "ci"))
os.chdir(root)
import certificate  # noqa: E402: it lies in ci/

counts = [0, 0]


def check(name, good):
    counts[not good] += 1
    print(("ok " if good else "not ok ") + name)


def whole():
    return {
        "stages": [{"stage": name, "bits": bits, "cases": 3, "mismatches": 0}
                   for name, bits in certificate.golden()],
        "scenes": [{"scene": name, "what": what, "mismatches": 0, "stages": 9,
                    "steps": certificate.SCENES[name], "digest": name,
                    "traced": certificate.SCENES[name]}
                   for name, what in certificate.WANTED],
        "sanitizers": [{"tool": name, "status": 0}
                       for name in certificate.TOOLS]}


def planted(name, part, key, value, row=0):
    """That one row of a part has another value, None: is not there."""
    faulty = copy.deepcopy(whole())
    if value is None:
        del faulty[part][row]
    else:
        faulty[part][row][key] = value
    check(f"{part}: {name}", len(certificate.faults(faulty)) == 1)


check("nothing is wrong with all", not certificate.faults(whole()))
for k, scene in enumerate(whole()["scenes"]):
    title = f"{scene['scene']}, {scene['what']}"
    planted(f"{title}: left out", "scenes", "", None, k)
    planted(f"{title}: a difference", "scenes", "mismatches", 1, k)
    few = scene["steps"] - 1
    if scene["what"] != "as graphs":  # which no trace sees
        planted(f"{title}: no stage", "scenes", "stages", 0, k)
    if scene["what"] == "ref and gpu":
        planted(f"{title}: {few} steps", "scenes", "steps", few, k)
        planted(f"{title}: hardly traced", "scenes", "traced", 2, k)
    if scene["what"] == "as graphs":
        faulty = copy.deepcopy(whole())
        faulty["scenes"][k].update(stages=0, steps=few)
        check(f"{title}: {few} steps", len(certificate.faults(faulty)) == 1)
        faulty["scenes"][k]["steps"] += 1
        check(f"{title}: all", not certificate.faults(faulty))
known = {name: name for name in certificate.SCENES}
check("digests are the reference's", not certificate.unlike(whole(), known))
known["flag"] = "0"
check("one is not", len(certificate.unlike(whole(), known)) == 1)
planted("left out", "stages", "", None)
planted("a difference", "stages", "mismatches", 1)
planted("no case", "stages", "cases", 0)
planted("left out", "sanitizers", "", None)
planted("a finding", "sanitizers", "status", 1)
print(f"{counts[0]} passed, {counts[1]} failed")
sys.exit(counts[1] > 0)
