#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants faults in copies of the device's code, which the proofs must find without
running it on a device: a proof that passes everything is worthless.

usage: ci/equal/faults.py    ends with `N passed, N failed`

Each fault is in a function of its own, and the twin that has this function must
differ; faults of one copy do not reach each other's twins. The last copy is compiled
by other flags. The lint must find what it shows.
"""
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BITS = "32"
COULOMB = f"build/ptx/gpu/contact/coulomb.{BITS}.ptx"
# Of each copy: (what, file, text, instead, twin).
COPIES = (
    (
        ("a + (b + c)", "gpu/narrow/filter.cuh",
         "(f[0] * n[0][i] + f[1] * n[1][i]) + f[2] * n[2][i]",
         "f[0] * n[0][i] + (f[1] * n[1][i] + f[2] * n[2][i])", "cubic_form"),
        ("< for <=", "gpu/contact/closest.cuh", "s + t <= 1", "s + t < 1",
         "nearest_vf"),
        ("fmin for a < b ? a : b", "gpu/contact/closest.cuh", "t = min_of(t, 1 - s);",
         "t = fmin(t, 1 - s);", "nearest_weights"),
        ("x · (1 / l) for x / l", "gpu/contact/closest.cuh",
         "return wide3(a.x / l, a.y / l, a.z / l);",
         "return scale(1 / l, a);", "unit"),
        ("a constant, by an ulp", "gpu/cloth/cloth.cuh", "R(0.21723362821122166)",
         "R(0.21723364)", "spring_tension"),
        (">= for >", "gpu/narrow/predicates.cuh", "if (fabs(det) > error)\n"
         "        return det > 0 ? 1 : -1;\n    /* §2.3",
         "if (fabs(det) >= error)\n        return det > 0 ? 1 : -1;\n    /* §2.3",
         "orient3"),
        (">= for > in a kernel", "gpu/contact/coulomb.cu", "bool slides = size > most;",
         "bool slides = size >= most;", "coulomb_evaluate_kernel"),
        ("a sum in another order in a kernel", "gpu/momentum/momentum.cu",
         "add(scale(s.keep, s.v[p]), add(s.dv, rotation))",
         "add(add(scale(s.keep, s.v[p]), s.dv), rotation)", "spin_kernel"),
        ("a stream for another in a kernel", "gpu/contact/unknowns.cu",
         "axpy(s.x0[i], s.dt, u)", "axpy(s.x1[i], s.dt, u)",
         "unknowns_shift_kernel"),
        ("a write too many in a kernel", "gpu/world/prescribed.cu",
         "if (fixed[i])\n        a[i] = old[i];", "a[i] = old[i];", "keep_kernel"),
    ),
    (
        ("the sign of a zero", "gpu/base/wide.cuh", "a.y * b.z - a.z * b.y",
         "-(a.z * b.y - a.y * b.z)", "wide_cross"),
        ("fabs for a < 0 ? -a : a", "gpu/base/real.cuh", "return a < 0 ? -a : a;",
         "return (real)fabs((double)a);", "magnitude"),
        ("a min at whose zeros nvcc's exchange shows", "gpu/contact/coulomb.cu",
         "return max_of(push, R(0.0));", "return -min_of(-push, R(0.0));", "lint"),
    ),
    (
        ("--fmad=true", "Makefile", "--fmad=false", "--fmad=true", "spring_slope"),
        ("--fmad=true", "Makefile", "--fmad=true", "--fmad=true", "lint"),
    ),
)


def plant(faults):
    """Makes a copy of the tree here with these faults; returns those that it could not
    plant."""
    for name in os.listdir(ROOT):
        if name not in ("gpu", "Makefile", "build", ".git"):
            os.symlink(os.path.join(ROOT, name), name)
    subprocess.run(["cp", "-r", os.path.join(ROOT, "gpu"),
                    os.path.join(ROOT, "Makefile"), "."], check=True)
    missing = []
    for what, path, text, instead, _ in faults:
        with open(path, encoding="utf-8") as file:
            old = file.read()
        if text not in old:
            missing.append(what)
        with open(path, "w", encoding="utf-8") as file:
            file.write(old.replace(text, instead, 1))
    return missing


def run(*command):
    """What a command prints."""
    return subprocess.run(command, check=False, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT).stdout


def found(faults):
    """Plants faults and looks for them; returns (what, where, whether it was found)."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        missing = plant(faults)
        twins = [twin for *_, twin in faults if twin != "lint"]
        said = run(sys.executable, "ci/equal/prove.py", "build", "--quick", "--bits",
                   BITS, "--only", *twins)
        if len(twins) < len(faults):
            run("make", "-s", COULOMB)
            said += "\n" + run(sys.executable, "ci/equal/lint.py", COULOMB)
        os.chdir(ROOT)
    for what, path, _, _, twin in faults:
        line = f"FAILED {twin} {BITS}: " if twin != "lint" else f"FAILED {COULOMB}: "
        yield (what, f"{path}: {twin}", what not in missing
               and re.search("^" + re.escape(line), said, re.M), said)


def main():
    """Plants all faults."""
    passed = failed = 0
    for faults in COPIES:
        for what, where, good, said in found(faults):
            passed += bool(good)
            failed += not good
            print(f"{'ok' if good else 'FAILED'} planted in {where}: {what}")
            if not good:
                print("    " + said.replace("\n", "\n    "))
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    os.chdir(ROOT)
    sys.exit(main())
