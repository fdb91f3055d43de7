#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether ci/check.py tells each failure by its name, and again at its end, and
whether ci/soak.py records what it ran, both in a tree of made-up parts; whether an
archive of fuzz/corpus follows from its inputs alone, and gains each of them once.

usage: tests/harness.py; ends with `N passed, N failed`
"""
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path[:0] = [os.path.join(ROOT, "ci"), os.path.join(ROOT, "fuzz")]
import corpus  # noqa: E402: it lies in fuzz/
import soak  # noqa: E402: it lies in ci/

MANY = "\n".join(f"print('FAILED check {k}: bad\\n  why {k}')" for k in range(50))
PARTS = {  # by the names of the files that the parts run
    "maps": "print('ok one\\nFAILED two: broke\\n  because\\nok three')\n"
            "print('2 passed, 1 failed')\nraise SystemExit(1)",
    "tree": "print('skipped: a: no foo (sh ci/deps.sh)')\n"
            "print('skipped: b: no foo (sh ci/deps.sh)')\n"
            "print('1 passed, 0 failed, 2 skipped')",
    "certificate": "raise SystemExit('died of it')",
}
FUZZER = """#!/bin/sh
echo 'stat::number_of_executed_units: 7'
sleep 0.2
exit {status}
"""
counts = [0, 0]


def check(name, good, said=""):
    counts[not good] += 1
    if not good:
        print(f"FAILED {name}\n{said}")


def write(path, text, mode=0o644):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    os.chmod(path, mode)


def run(*command):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    return done.returncode, done.stdout


def checks():
    """`make check` of three parts, of which two fail."""
    os.symlink(os.path.join(ROOT, "ci"), "ci")
    program = os.path.join(ROOT, "ci/check.py")
    for name, text in PARTS.items():
        write(f"tests/{name}.py", text)
    status, said = run(sys.executable, program, "build", "maps", "tokens", "rows")
    lines = said.splitlines()
    check("check: the status", status == 1, said)
    check("check: what there is", lines[0].startswith("3 parts,") and
          lines[1].split()[0] == "maps", said)
    last = [line for line in lines if " passed, " in line][-1]
    check("check: the counts", last.startswith("3 passed, 2 failed, 2 skipped in")
          and "failed: " in last and "maps" in last and "rows" in last, said)
    check("check: one line a reason",
          "tokens: skipped: a; b: no foo (sh ci/deps.sh)" in lines, said)
    end = said[said.index("\nfailed: "):]
    check("check: a failure again, with what follows it",
          "FAILED two: broke\n  because\n" in end and "ok three" not in end, said)
    check("check: how a part died", "FAILED rows" in end and "died of it" in end, said)
    check("check: the log of a failure", os.path.exists("build/check-maps.log") and
          not os.path.exists("build/check-tokens.log"), said)
    check("check: times for the next run", '"maps"' in open("build/check.times").read())

    write("tests/maps.py", MANY + "\nprint('0 passed, 50 failed')")
    status, said = run("sh", "ci/part.sh", "build", "maps")
    check("part: all failures", status == 1 and
          all(f"FAILED check {k}: bad\n  why {k}\n" in said for k in range(50)), said)
    write("tests/maps.py", "print('1 passed, 0 failed')\nraise SystemExit(3)")
    status, said = run("sh", "ci/part.sh", "build", "maps")
    check("part: counts do not hide a status", status == 1, said)

    write("Makefile", "check-parts:\n\t@echo 'x.c:1: error: no such type'; exit 1\n")
    status, said = run(sys.executable, program, "build", "build", "tokens")
    check("check: nothing runs after a build that failed", status == 1 and
          "error: no such type" in said and "tokens   " in said and
          "tokens       1 passed" not in said, said)


def soaks():
    """A soak of three targets, of which one crashes."""
    write("build/replay", "#!/bin/sh\necho a b c\n", 0o755)
    for name, status in (("a", 0), ("b", 77), ("c", 0)):
        write(f"build/fuzz/{name}", FUZZER.format(status=status), 0o755)
    command = [sys.executable, os.path.join(ROOT, "ci/soak.py"), "build", "2"]
    status, said = run(*command, "r.csv")
    rows = soak.Record("r.csv", []).rows
    check("soak: the record", status == 1 and list(rows) == ["a", "b", "c"] and
          all(row[1] >= 7 for row in rows.values()), said)
    check("soak: the crash", "FAILED b" in said and rows["b"][2] > 0 and
          rows["a"][2] == rows["c"][2] == 0, said)
    write("r.csv", "target,seconds,executions,crashes\na,9,70,0\nb,9,70,1\nc,8,7,0\n")
    status, said = run(*command, "r.csv", "a", "c")
    again = soak.Record("r.csv", []).rows
    check("soak: it goes on where it was", status == 0 and again["c"][1] > 7 and
          again["b"] == [9, 70, 1], said)
    check("soak: the one with the least first", said.startswith("c: "), said)

    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    run(*git, "init", "-q", ".")
    for k in range(2):
        run(*git, "commit", "-q", "--allow-empty", "-m", str(k))
    targets = list("pqrstuv")
    check("soak: the second turn", soak.of_this_turn(targets, 3) == list("vpq"))
    run(*git, "commit", "-q", "--allow-empty", "-m", "2")
    check("soak: the third turn", soak.of_this_turn(targets, 3) == list("rst"))


def archives():
    """Those of the tree, written again, and one that gains inputs."""
    paths = [os.path.join(corpus.CORPORA, name) for name in os.listdir(corpus.CORPORA)]
    for path in paths:
        corpus.write("again.tar", corpus.read(path))
        same = [open(each, "rb").read() for each in (path, "again.tar")]
        check(f"corpus: {path}, written again", same[0] == same[1] and
              path.endswith(".tar") and corpus.read(path))
    check("corpus: there are archives", len(paths) > 50)
    write("one", "1")
    write("two", "2")
    for name, files, more in (("a", ["one"], 1), ("a", ["two", "one"], 1),
                              ("a", ["one"], 0), ("b", ["two", "one"], 2)):
        count = corpus.add(f"{name}.tar", corpus.files(files))
        check(f"corpus: {files} make {more} more in {name}", count == more)
    check("corpus: the order does not show", corpus.read("a.tar") ==
          {"one": b"1", "two": b"2"} and
          open("a.tar", "rb").read() == open("b.tar", "rb").read())


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    checks()
    soaks()
    archives()
    os.chdir(ROOT)
print(f"{counts[0]} passed, {counts[1]} failed")
sys.exit(counts[1] > 0)
