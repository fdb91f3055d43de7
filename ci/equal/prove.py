#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves that device code performs the operations of its twin in ref/.

usage: ci/equal/prove.py BUILD [--quick | --write] [--bits 32|64] [--jobs N]
       [--only NAME...]; ends with `N passed, N failed, N skipped`

For each row of ci/equal/twins.def and both precisions, the PTX that nvcc makes of
the device's side and the code that clang -O0 makes of the reference's are executed
symbolically, and what they leave in memory is compared (compare.py). What
spec/proofs.md records as proved must be proved. --quick: only what rewriting proves
there, but for launches and LONG rows; the solver is not asked. --write: writes the
tables of spec/proofs.md anew.
"""
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time

import compare
import page
import question
import table
from term import TABLE, Unsupported

TWINS = "ci/equal/twins.def"
QUICK, LONGEST = 30, 120 # seconds of a processor for a twin in one precision
BITS = (32, 64)


def decide(build, twin, bits, quick, again=False):
    """The verdict on a twin: by rewriting, then by the solver, and each by either way
    to write comparisons until one proves or refutes it. again: on what two sets of
    flags make of the device's side (versions.py)."""
    sides = ("again", "build") if again else ("reference", "device")
    for rewriting in (True, False):
        for zeros in (False, True):
            TABLE.start(zeros)
            pairs, given = question.question(build, twin, bits, again)
            verdict = compare.decide(pairs, given, rewriting, os.path.relpath, sides)
            if verdict.kind != "open":
                return verdict
        if quick:
            break
    return verdict


def too_late(*_):
    """The clock rings."""
    raise Unsupported("it takes too long")


def verdict_on(task):
    """The same of decide's arguments, open where the engine has no answer or none in
    time, and seconds."""
    quick = task[3]
    began = time.monotonic()
    signal.signal(signal.SIGVTALRM, too_late)
    signal.setitimer(signal.ITIMER_VIRTUAL, QUICK if quick else LONGEST)
    try:
        verdict = decide(*task)
    except (Unsupported, FileNotFoundError) as why:
        verdict = compare.Verdict("open", str(why))
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return verdict, time.monotonic() - began


def compile_all(build, twins, widths, jobs):
    """Writes the wrappers and compiles them, and the kernels of KERNEL rows; returns
    whether all could be compiled."""
    groups = list({twin.group.name: twin.group for twin in twins}.values())
    table.write(groups, os.path.join(build, "equal"))
    targets = []
    for bits in widths:
        for group in groups:
            names = [group.name, *map(table.link_name, group.linked)]
            targets += [f"{build}/equal/{name}.{bits}.ll" for name in names]
            if any(not twin.kernel for twin in group.rows):
                targets.append(f"{build}/equal/{group.name}.{bits}.ptx")
            if any(twin.kernel for twin in group.twins):
                path = re.sub(r"\.cu$", f".{bits}.ptx", group.device)
                targets.append(f"{build}/ptx/{path}")
    if "jobserver" not in os.environ.get("MAKEFLAGS", ""):
        targets.append(f"-j{jobs}")
    made = subprocess.run(["make", "-sk", f"BUILD={build}", *targets], check=False)
    return made.returncode == 0


def tell(twin, bits, verdict, wanted, seconds):
    """Prints a verdict; returns whether it passes, or None where nothing is wanted."""
    good = verdict.kind == "equal"
    bad = verdict.kind == "differs" or (wanted and not good)
    mark = "FAILED" if bad else "proved" if good else "open"
    print(f"{mark} {twin.name} {bits}: {verdict.how}, {verdict.terms} terms, "
          f"{verdict.asked} questions, {seconds:.2f} s")
    for line in verdict.detail:
        print("    " + line)
    sys.stdout.flush()
    return False if bad else True if good else None


def option(options, name):
    """What follows an option, up to the next."""
    if name not in options:
        return []
    after = list(options)[options.index(name) + 1:]
    return after[:next((k for k, x in enumerate(after) if x[:2] == "--"), len(after))]


def main(build, *options):
    """Asks what is to be asked and tells what it found."""
    quick, only = "--quick" in options, option(options, "--only")
    widths = [int(x) for x in option(options, "--bits")] or BITS
    every = [twin for group in table.read(TWINS) for twin in group.twins]
    known, verdicts = page.recorded(), {}
    twins = [t for t in every if not only or t.name in only]
    todo = [(t, bits) for t in twins for bits in widths
            if not quick or only
            or (known.get((t.name, bits)) == "rewriting" and not t.long)]
    jobs = int((option(options, "--jobs") or [len(os.sched_getaffinity(0))])[0])
    results = [compile_all(build, [t for t, _ in todo], widths, jobs)]
    if not results[0]:
        print("FAILED the wrappers: they do not compile")
    with multiprocessing.Pool(jobs) as pool:
        tasks = [(build, twin, bits, quick) for twin, bits in todo]
        for (twin, bits), (verdict, seconds) in zip(todo, pool.imap(verdict_on, tasks)):
            verdicts[twin.name, bits] = verdict
            wanted = "--write" not in options and not known.get(
                (twin.name, bits), "open").startswith("open")
            results.append(tell(twin, bits, verdict, wanted, seconds))
    if "--write" in options:
        page.write(every, verdicts)
    elif not only:
        results += page.check(every, None if quick else verdicts)
    left = len(twins) * len(widths) - len(todo)
    if left:
        print(f"skipped: {left} questions: only the solver proves them (make prove)")
    print(f"{results.count(True)} passed, {results.count(False)} failed, "
          f"{results.count(None) + left} skipped")
    return 1 if False in results else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
