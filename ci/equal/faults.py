#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants faults in copies of the device's code, which the proofs must find without
running it on a device: a proof that passes everything is worthless.

usage: ci/equal/faults.py    ends with `N passed, N failed, N skipped`

Each fault is in a function of its own, and the twin that has this function must
differ; faults of one copy do not reach each other's twins. The last copy is compiled
by other flags. The lint must find what it shows. PROVERS has faults for the other
proofs, each of which must fail by name.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

import sass

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
        ("a spring's ends in another order, of lanes that work together",
         "gpu/solve/edges.cuh", "y = add(sub(y, less[k]), plus[k]);",
         "y = sub(add(y, plus[k]), less[k]);", "gather_kernel_springs"),
        ("a spring's ends in another order, of a tile in shared memory",
         "gpu/cloth/springs.cuh", "f = sub(add(f, from), to);", "f = add(sub(f, to), from);",
         "springs_kernel_springs"),
        ("<= for < of a certain sign", "gpu/narrow/filter.cuh", "down = down || sign < 0;",
         "down = down || sign <= 0;", "opposed"),
        ("the finer grid's damping", "gpu/solve/sewn.cu",
         "place_of(c->l.g, item), c->damping);", "place_of(c->l.g, item), f->damping);",
         "sewn_restrict_kernel"),
        ("a residual that need not halve", "gpu/solve/pcg.cuh",
         "if (!(c->residual <= c->before / 2)) {", "if (!(c->residual <= c->before)) {",
         "restarts"),
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


VENV = os.path.join(ROOT, "build/equal/venv/bin/python")
NVDISASM = sass.nvdisasm(os.path.join(ROOT, "build")) or "nvdisasm"
# Of each prover: (command, what it needs, faults as above, with the line that fails).
PROVERS = (
    ((VENV, "ci/equal/carries.py", "build"), VENV, (
        ("a lost carry of a column", "gpu/narrow/big.cuh", "over += sum < p;", "",
         "gpu: a column's step"),
        ("a lost carry of a row", "ref/narrow/big.c", "carry += x * b.d[j] + d[i + j];",
         "carry = x * b.d[j] + d[i + j];", "ref: a row's step"),
        ("a lost borrow", "ref/narrow/big.c", "borrow = a.d[i] < take;", "borrow = 0;",
         "ref: a difference's step"),
    )),
    ((sys.executable, "ci/equal/bits.py"), "gappa", (
        ("an arena that is too small", "gpu/narrow/narrow.cu", "LONG_ROOM = 65536",
         "LONG_ROOM = 16384", "a pair, words of LONG_ROOM"),
        ("a word too few", "ref/narrow/predicates.c", "WORDS = 36", "WORDS = 35",
         "a difference of orient3, words of the reference"),
    )),
    ((sys.executable, "ci/equal/bounds.py", "build"), "gappa", (
        ("a bound that is not used", "gpu/narrow/predicates.cuh",
         "ERROR_ORIENT3 * sum + UNDERFLOW", "UNDERFLOW", "orient3, device"),
        ("a bound times 0.99", "ref/narrow/predicates.c", "ERROR_ORIENT2 0x1p-50",
         "ERROR_ORIENT2 (0.99 * 0x1p-50)", "orient2, reference"),
        ("a bound of a quarter", "gpu/narrow/facing.cuh", "ERROR_OPENED 0x1p-48",
         "ERROR_OPENED 0x1p-50", "opened, device"),
        ("a sum without a magnitude", "ref/narrow/tritri.c",
         "ERROR_BESIDE * dot_size(t->size, d)", "ERROR_BESIDE * dot_size(t->n, d)",
         "beside_plane, reference"),
        ("a form's bound of a half", "gpu/narrow/filter.cuh", "ERROR_FORM 0x1p-47",
         "ERROR_FORM 0x1p-48", "form 1, device 64"),
        ("V's bound of a half", "ref/narrow/filter.c", "ERROR_CUBIC 0x1p-45",
         "ERROR_CUBIC 0x1p-46", "V, reference 64"),
        ("a box form's bound of a half", "ref/narrow/filter.c", "ERROR_BOX 0x1p-51",
         "ERROR_BOX 0x1p-52", "box form, reference 64"),
        ("a reach too short", "ref/broad/box.h", "BOX_REACH 16", "BOX_REACH 4",
         "box_reach, reference 32"),
        ("times too tight", "ref/broad/box.h", "BOX_LATE 32", "BOX_LATE 16",
         "box_late, device 32"),
        ("a margin of an eighth", "gpu/broad/cones.cuh", "CONES_ROOM 32", "CONES_ROOM 4",
         "cones_room of c, device 64"),
        ("a plane's bound of a quarter", "gpu/narrow/facing.cuh", "ERROR_PARTED 0x1p-49",
         "ERROR_PARTED 0x1p-51", "parted, device 64"),
        ("the grid's bound of a sixteenth", "gpu/narrow/point.cuh",
         "ERROR_ROUGH 0x1p-46", "ERROR_ROUGH 0x1p-50", "narrow_rough, device 64"),
    )),
    ((sys.executable, "ci/equal/bounds.py", "build"), "gappa", (
        ("a form's bound that is not used", "gpu/narrow/filter.cuh",
         "ERROR_FORM * (y * z) + UNDERFLOW", "UNDERFLOW", "forms, device 64"),
        ("a form's bound of other axes", "ref/narrow/filter.c",
         "ERROR_FORM * (d[i] * d[j])", "ERROR_FORM * (d[i] * d[k])",
         "forms, reference 64"),
        ("V's bound that is not used", "ref/narrow/filter.c",
         "ERROR_CUBIC * (d[0] * d[1] * d[2]) + UNDERFLOW", "UNDERFLOW",
         "cubic, reference 64"),
        ("a range that is not used", "ref/narrow/filter.c", "d[k] <= RANGE",
         "d[k] <= INFINITY", "RANGE, reference 64"),
        ("a box form's bound that is not used", "gpu/narrow/split.cuh",
         "ERROR_BOX * size + UNDERFLOW", "UNDERFLOW", "box_forms, device 64"),
        ("a reach that is not used", "ref/broad/box.h",
         "return r * (1 + BOX_REACH * REAL_UNIT);", "return r;", "reach, reference 64"),
        ("nor by the device's host", "gpu/broad/box.cuh",
         "return r * (1 + BOX_REACH * REAL_UNIT);", "return r;", "reach, device 64"),
        ("times without room", "gpu/broad/box.cuh", "late * (1 + BOX_LATE * REAL_UNIT)",
         "late", "late, device 32"),
        ("a margin that is not used", "ref/broad/cones.c", "CONES_ROOM * REAL_UNIT", "0",
         "cones, reference 32"),
        ("a plane's bound that is not used", "ref/narrow/tritri.c",
         "ERROR_PARTED * dot_size(u, d)", "0 * dot_size(u, d)", "plane, reference 64"),
        ("the grid's bound that is not used", "gpu/narrow/point.cuh",
         "ERROR_ROUGH * size + UNDERFLOW_ROUGH", "UNDERFLOW_ROUGH", "rough, device 64"),
        ("closest points summed in another order", "ref/narrow/closest.c",
         "wide_scale(c[1], y[1]);\n    p = wide_axpy(p, c[2], y[2]);\n"
         "    p = wide_axpy(p, c[3], y[3]);",
         "wide_scale(c[3], y[3]);\n    p = wide_axpy(p, c[2], y[2]);\n"
         "    p = wide_axpy(p, c[1], y[1]);",
         "spec/proofs/closest_point.gappa, closest_point, reference 64"),
        ("a parameter that is not clamped", "gpu/contact/closest.cuh",
         "return a < b ? a / b : 1;", "return a / b;", "closest, device 64"),
        ("the shortest p times 0.99", "gpu/contact/proximity.cu",
         "r->length2 > 0x1p-80 * r->size2", "r->length2 > 0.99 * 0x1p-80 * r->size2",
         "shortest p with a direction, device"),
        ("the shortest p that is not used", "ref/contact/proximity.c",
         "r->length2 > 0x1p-80 * r->size2", "r->length2 > 0",
         "shortest p with a direction, reference"),
        ("an axis without room", "gpu/contact/far.cuh",
         "(1 + R(0x1p-10)) * (square * dd)", "square * dd", "room of an axis, device"),
    )),
    ((sys.executable, "ci/equal/sass.py", "build", NVDISASM), NVDISASM, (
        ("--fmad=true", "Makefile", "--fmad=false", "--fmad=true",
         "cross 32 of machine code"),
        ("a difference for a sum", "gpu/base/real.cuh", "a.xx + b.xx", "a.xx - b.xx",
         "add_sym 64 of machine code"),
    )),
    (("sh", "ci/eva/eva.sh", "build"), "frama-c", (
        ("an index too far", "ref/narrow/filter.c",
         "for (int k = 0; k < 3; k++)\n        c[k] = a[k] - b[k];",
         "for (int k = 0; k <= 3; k++)\n        c[k] = a[k] - b[k];", "filter: 1 alarm"),
        ("a variable without a value", "ref/narrow/tritri.c",
         "unsigned above = 0, below = 0;", "unsigned above, below = 0;", "tritri: 1 alarm"),
        ("a contract that allows too much", "ref/narrow/split.h", "3 <= m->count <= 4",
         "3 <= m->count <= 5", "split"),
        ("a contract that leaves code out", "ref/narrow/closest.h",
         "requires 0 <= kind <= 1;\n  @ requires", "requires 1 <= kind <= 1;\n  @ requires",
         "closest"),
    )),
)


def plant(faults):
    """Makes a copy of the tree here with these faults; returns those that it could not
    plant."""
    own = {path.split("/")[0] for _, path, *_ in faults} | {"Makefile"}
    for name in os.listdir(ROOT):
        if name not in (*own, "build", ".git"):
            os.symlink(os.path.join(ROOT, name), name)
    subprocess.run(["cp", "-r", *(os.path.join(ROOT, name) for name in own), "."],
                   check=True)
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


def refused(command, faults):
    """Plants faults of a prover; yields the same."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        missing, said = plant(faults), run(*command)
        os.chdir(ROOT)
    for what, path, _, _, name in faults:
        yield (what, f"{path}: {name}", what not in missing and re.search(
            "^FAILED " + re.escape(name) + ":?(?: |$)", said, re.M), said)


def all_faults():
    """What was found of all faults; None where a tool is missing."""
    for faults in COPIES:
        yield from found(faults)
    for command, tool, faults in PROVERS:
        if shutil.which(tool):
            yield from refused(command, faults)
        else:
            print(f"skipped: faults of {command[1]}: there is no {tool}")
            yield from (None for _ in faults)


def main():
    """Plants all faults."""
    passed = failed = skipped = 0
    for fault in all_faults():
        if fault is None:
            skipped += 1
            continue
        what, where, good, said = fault
        passed += bool(good)
        failed += not good
        print(f"{'ok' if good else 'FAILED'} planted in {where}: {what}")
        if not good:
            print("    " + said.replace("\n", "\n    "))
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    os.chdir(ROOT)
    sys.exit(main())
