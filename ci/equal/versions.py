#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares what nvcc makes of the device's code by two sets of flags, or what two nvcc
make of it, for every input.

usage: ci/equal/versions.py BUILD [--nvcc PATH | --swap WORD WORDS] [--bits 32|64]
       [--only NAME... | --all]; ends with `N passed, N failed, N skipped`

PTX by the build's flags and PTX for which the command has other WORDS in place of WORD
are executed symbolically, as in prove.py. `equal` is so for every input; else the
first operations that differ are told, and an input that shows it. A row that differs
fails. --all: all rows but launches and LONG ones. Of a kernel both must compute addresses in the same way. Without --nvcc and
--swap: CASES, whose rows must be equal or differ as there.
"""
import collections
import multiprocessing
import os
import shutil
import subprocess
import sys

import prove
import question
import table

ROWS = ("cross", "add_sym", "between", "nearest_weights", "orient3", "spread",
        "spring_slope", "spin_kernel")
CONTRACTED = ("cross", "between", "spring_slope", "spin_kernel")
# A word of the command, what stands for it, and the rows that are equal and that differ.
Case = collections.namedtuple("Case", "word words equal differ")
CASES = (
    Case("-O2", "-O2 -Xcicc -O0", ROWS, ()),
    Case("-arch=%", "-arch=compute_75", ROWS, ()),
    Case("--fmad=false", "--fmad=true", ("add_sym", "nearest_weights"), CONTRACTED),
)


def compile_again(build, twins, widths, case):
    """Compiles the device's sides by other words; returns whether all could be."""
    question.parsed.cache_clear()
    shutil.rmtree(os.path.join(build, "equal/again"), ignore_errors=True)
    os.makedirs(os.path.join(build, "equal/again"))
    names = {t.group.device[:-3] if t.kernel else t.group.name for t in twins}
    made = subprocess.run(
        ["make", "-sk", f"BUILD={build}", f"SWAP={case.word}", f"FOR={case.words}",
         f"-j{len(os.sched_getaffinity(0))}",
         *(f"{build}/equal/again/{name}.{bits}.ptx" for name in sorted(names)
           for bits in widths)], check=False)
    return made.returncode == 0


def tell(twin, bits, verdict, case):
    """Prints a verdict; returns whether it is the case's, or None where it is open."""
    wanted = "differs" if twin.name in case.differ else "equal"
    good = None if verdict.kind == "open" else verdict.kind == wanted
    print(f"{'open' if good is None else 'ok' if good else 'FAILED'} {twin.name} {bits}, "
          f"{case.words} for {case.word}: {verdict.kind}, {verdict.how}")
    for line in verdict.detail:
        print("    " + line)
    sys.stdout.flush()
    return good


def main(build, *options):
    """Compares and tells what it found."""
    nvcc, swap = (prove.option(options, name) for name in ("--nvcc", "--swap"))
    widths = [int(x) for x in prove.option(options, "--bits")] or prove.BITS
    every = [t for g in table.read(prove.TWINS) for t in g.twins]
    only = tuple(prove.option(options, "--only")) or ROWS
    only = tuple(t.name for t in every if not t.long) if "--all" in options else only
    asked = ["nvcc", *nvcc] if nvcc else swap
    cases = [Case(asked[0], " ".join(asked[1:]), only, ())] if asked else CASES
    twins = [t for t in every if t.name in only]
    results = [prove.compile_all(build, twins, widths, 2) and len(twins) == len(only)]
    if not results[0]:
        print("FAILED the rows: they are not there or do not compile")
    for case in cases:
        made = compile_again(build, twins, widths, case)
        results.append(made)
        print(f"{'ok' if made else 'FAILED'} {case.words} for {case.word} compiles")
        rows = [t for t in twins if t.name in case.equal + case.differ]
        tasks = [(build, twin, bits, True, True) for twin in rows
                 for bits in widths] if made else []
        with multiprocessing.Pool() as pool:
            for (_, twin, bits, *_), (verdict, _) in zip(
                    tasks, pool.imap(prove.verdict_on, tasks)):
                results.append(tell(twin, bits, verdict, case))
    print(f"{results.count(True)} passed, {results.count(False)} failed, "
          f"{results.count(None)} skipped")
    return 1 if False in results else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
