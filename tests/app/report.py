# SPDX-License-Identifier: Apache-2.0
"""Checks the files of runs without the tool; called by tests/app/*.sh.

usage: report.py same A B         two runs are equal except for times
       report.py sums DIR         the summary agrees with the steps' reports
       report.py rows DRAPE CK    each field of a report's row, the sums and the
                                  ranges, by checkpoints made here from CK
       report.py damage DRAPE CK  a checkpoint with a wrong byte is refused
Fails with a line that names the place.
"""
import filecmp
import json
import math
import os
import struct
import subprocess
import sys

# The header of app/write/checkpoint.h and drape_step_report, in the host's layout.
HEADER = struct.Struct("@16s Q Q q d 3d 2d 2i")
ROW = struct.Struct("@q d 4i d 2i 7q 3d 5d 4i 6q")
OUTCOME, SECONDS, WORK = 2, slice(19, 24), slice(24, 34)
FIELDS = ["step", "time", "outcome", "slices", "substeps", "iterations",
          "residual", "rounds", "asleep", "contacts", "impacts", "candidates",
          "zone_vertices", "rolled_back", "intersecting", "sewn", "kinetic",
          "elastic", "potential"]
PARTS = ["integration", "solver", "broad", "proximity", "penetration"]
WORKS = ["tries", "solves", "queries", "narrow", "boxes", "boxes_kept",
         "walked", "cleared", "near", "later"]
OUTCOMES = ["unconverged", "zones", "rollback", "trapped", "diverged",
            "asleep", "passed"]
TRAPPED, DIVERGED, PASSED = 8, 16, 64


def load(directory):
    """report.json, which has to be JSON by the letter and UTF-8."""
    def refuse(constant):
        raise ValueError("%s is no JSON" % constant)
    with open(os.path.join(directory, "report.json"), "rb") as file:
        return json.loads(file.read().decode("utf-8"), parse_constant=refuse)


# Two runs

def strip(report):
    """Without times, and the memory that a process came to need."""
    for key in ["memory", "held_bytes", "file"]:
        del report[key]
    for row in report["plan"]:
        del row["bytes"]
    del report["summary"]["seconds"], report["summary"]["part_seconds"]
    for step in report["steps"]:
        del step["seconds"]
    return report


def trace(directory):
    """Rows without their times, or None."""
    path = os.path.join(directory, "trace.csv")
    if not os.path.exists(path):
        return None
    with open(path) as file:
        return [line.split(",")[:3] for line in file]


def same(a, b):
    one, two = strip(load(a)), strip(load(b))
    for key in sorted(one.keys() | two.keys()):
        assert one.get(key) == two.get(key), "report: " + key
    names = []
    for root, _, files in os.walk(a):
        names += [os.path.relpath(os.path.join(root, f), a) for f in files]
    others = []
    for root, _, files in os.walk(b):
        others += [os.path.relpath(os.path.join(root, f), b) for f in files]
    apart = {"report.json", "trace.csv", "checkpoint.drape"}
    names, others = set(names) - apart, set(others) - apart
    assert names == others, "files: %s" % sorted(names ^ others)
    assert len(names) > 2, "no files"
    for name in names:
        assert filecmp.cmp(os.path.join(a, name), os.path.join(b, name),
                           shallow=False), name
    assert trace(a) == trace(b), "trace.csv"


# A report

def check_sums(report):
    """The summary against the steps, which are added up here."""
    steps, total = report["steps"], report["summary"]
    words = [s["outcome"].split("+") for s in steps]
    done = [s for s in steps if "diverged" not in s["outcome"]]
    assert total["steps"] == len(done), "steps"
    assert list(total["outcomes"]) == OUTCOMES, "outcomes"
    for name in OUTCOMES:
        assert total["outcomes"][name] == sum(name in w for w in words), name
    for most, name in [("most_contacts", "contacts"), ("most_rounds", "rounds"),
                       ("most_iterations", "iterations")]:
        assert total[most] == max([s[name] for s in steps], default=0), most
    for name in WORKS:
        assert total["work"][name] == sum(s["work"][name] for s in steps), name
    for name in PARTS:
        all_of_it = sum(s["seconds"][name] for s in steps)
        assert math.isclose(total["part_seconds"][name], all_of_it,
                            rel_tol=1e-4, abs_tol=1e-4), name
    bad = [s["step"] for s, w in zip(steps, words) if "trapped" in w]
    assert total["intersecting"] == {
        "count": len(bad), "first": bad[0] if bad else None,
        "last": bad[-1] if bad else None}, "intersecting"


# Checkpoints made by this script

def checksum(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 & (2 ** 64 - 1)
    return struct.pack("@Q", value)


def read(path):
    """Header, rows and the library's bytes of a checkpoint."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[-8:] == checksum(data[:-8]), "checksum of " + path
    header = list(HEADER.unpack_from(data))
    assert header[1] == ROW.size, "a row has %d bytes" % header[1]
    rows = [list(ROW.unpack_from(data, HEADER.size + k * ROW.size))
            for k in range(header[3])]
    return header, rows, data[HEADER.size + len(rows) * ROW.size:-8]


def write(path, header, rows, state):
    data = HEADER.pack(*header)
    data += b"".join(ROW.pack(*row) for row in rows) + state
    with open(path, "wb") as file:
        file.write(data + checksum(data))


def resume(drape, path, frames):
    done = subprocess.run(
        [drape, "run", "tiny.json", "--frames", str(frames), "--resume", path,
         "--out", "crafted", "--no-obj", "--force"], capture_output=True,
        text=True)
    return done.returncode, done.stdout, done.stderr


def refused(drape, path, words):
    """Whether it is refused in one line that has these words."""
    status, out, err = resume(drape, path, 6)
    return (status == 2 and not out and len(err.splitlines()) == 1 and
            path in err and words in err and not os.path.exists("crafted"))


def invent(rows):
    """Another value in every field of every row: whoever takes one for another
    is seen. Outcomes are all that a step can have and go on."""
    made = []
    for k, row in enumerate(rows):
        new = [1000 * j + k for j in range(len(row))]
        new[0], new[1] = row[0], row[1]
        new[OUTCOME] = k % 128 & ~DIVERGED
        for j in [6, 16, 17, 18, *range(SECONDS.start, SECONDS.stop)]:
            new[j] += 0.125
        made.append(new)
    return made


def check_row(row, step):
    names = [n for k, n in enumerate(OUTCOMES) if row[OUTCOME] >> k & 1]
    assert step["outcome"] == ("+".join(names) or "clean"), step["outcome"]
    for name, value in zip(FIELDS, row):
        if name != "outcome":
            assert step[name] == value, "%s of step %d" % (name, row[0])
    assert list(step["seconds"]) == PARTS
    for name, value in zip(PARTS, row[SECONDS]):
        assert math.isclose(step["seconds"][name], value, rel_tol=1e-5), name
    work = dict(zip(WORKS, row[WORK]))
    assert step["work"] == work, "work of step %d" % row[0]


def check_rows(drape, path):
    header, rows, state = read(path)
    assert len(rows) > 512 and [r[0] for r in rows] == [
        k + 1 for k in range(len(rows))], "the checkpoint's own rows"
    told = load(os.path.dirname(path))["summary"]["seconds"]
    assert math.isclose(header[4], told, rel_tol=1e-4), "the run's seconds"
    made = invent(rows)
    header[4] = 7e5  # seconds
    write("made.drape", header, made, state)
    status, out, err = resume(drape, "made.drape", len(rows))
    assert status == 1, "not clean, but exit %d" % status
    report = load("crafted")
    assert report["end"] == "complete" and len(report["steps"]) == len(rows)
    assert 7e5 <= report["summary"]["seconds"] < 7.001e5, "seconds"
    for row, step in zip(made, report["steps"]):
        check_row(row, step)
    check_sums(report)
    bad = [r[0] for r in made if r[OUTCOME] & TRAPPED]
    unclean = sum(1 for r in made if r[OUTCOME] & (TRAPPED | PASSED))
    assert "%d of %d steps are not clean" % (unclean, len(rows)) in err, err
    late = sum(1 for r in made if r[OUTCOME] & 1)
    assert "note: the solver missed its tolerance in %d steps\n" % late in err
    assert "%d of them intersect at their end, from step %d to step %d" % (
        len(bad), bad[0], bad[-1]) in out, out
    subprocess.run(["rm", "-r", "crafted"], check=True)
    check_ranges(drape, header, rows[:6], state)


def check_bounds(drape, header, rows, state):
    """The greatest and the least values that a run can have."""
    for high in (True, False):
        row, head = list(rows[3]), list(header)
        for j in [*range(9, 16), *range(28, 34)]:
            row[j] = 2 ** 40 if high else 0
        for j in [3, 4, 5, 7, 8, *range(24, 28)]:
            row[j] = 2 ** 31 - 1 if high else 0
        row[OUTCOME] = 127 & ~DIVERGED if high else 0
        for j in [1, 6, 16, 17, *range(SECONDS.start, SECONDS.stop)]:
            row[j] = 1e300 if high else 0.0
        row[18] = -1e300
        head[4], head[10], head[11] = (1e9, 10 ** 9, 6) if high else (0.0, 1, 0)
        write("made.drape", head, rows[:3] + [row] + rows[4:], state)
        status, _, err = resume(drape, "made.drape", 6)
        assert status in (0, 1), err
        subprocess.run(["rm", "-r", "crafted"], check=True)


def check_ranges(drape, header, rows, state):
    """Values that no run has, under a checksum that is right."""
    header[3] = len(rows)
    check_bounds(drape, header, rows, state)
    nan, inf = float("nan"), float("inf")
    tries = [(0, 7), (1, nan), (1, -1.0), (2, 128), (2, -1), (2, DIVERGED)]
    tries += [(j, -1) for j in [3, 4, 5, 7, *range(8, 16),
                                *range(WORK.start, WORK.stop)]]
    tries += [(j, 2 ** 41) for j in [*range(9, 16), *range(28, 34)]]
    tries += [(j, v) for j in [6, 16, 17, 18] for v in [nan, inf]]
    tries += [(j, v) for j in range(SECONDS.start, SECONDS.stop)
              for v in [nan, inf, -1.0]]
    for j, value in tries:
        row = list(rows[3])
        row[j] = value
        write("made.drape", header, rows[:3] + [row] + rows[4:], state)
        words = "step 4: a value is out of range"
        assert refused(drape, "made.drape", words), "field %d, %r" % (j, value)
    for j, value, words in [(1, 8, "another build"), (2, 7, "another scene")]:
        wrong = list(header)
        wrong[j] = value
        write("made.drape", wrong, rows, state)
        assert refused(drape, "made.drape", words), words
    write("made.drape", header, rows, state + b"x")
    assert refused(drape, "made.drape", "has bytes behind its end")
    for j, value in [(4, nan), (4, -1.0), (3, -1), (10, 0), (10, 10 ** 9 + 1),
                     (11, 7), (11, -1), (5, nan), (5, -1.0), (5, 1000.5)]:
        wrong = list(header)
        wrong[j] = value
        write("made.drape", wrong, rows, state)
        assert refused(drape, "made.drape", "out of range"), \
            "header's field %d, %r" % (j, value)


def check_damage(drape, path):
    """One bit changed all over the file, cut off and added to."""
    with open(path, "rb") as file:
        data = file.read()
    places = sorted({*range(0, len(data), max(1, len(data) // 150)),
                     *range(16, HEADER.size, 3), len(data) - 1})
    assert len(places) > 100
    wrong = [data[:k] + bytes([data[k] ^ 1 << k % 8]) + data[k + 1:]
             for k in places]
    wrong += [data[:k] for k in [17, 100, 1000, len(data) - 8, len(data) - 1]]
    wrong += [data + b"x", data + data[-8:], data + bytes(4096)]
    for k, bytes_there in enumerate(wrong):
        with open("made.drape", "wb") as file:
            file.write(bytes_there)
        words = "not a checkpoint" if bytes_there[:10] != data[:10] else \
            "another version" if bytes_there[:16] != data[:16] else "damaged"
        assert refused(drape, "made.drape", words), "number %d" % k


if sys.argv[1] == "same":
    same(sys.argv[2], sys.argv[3])
elif sys.argv[1] == "sums":
    check_sums(load(sys.argv[2]))
elif sys.argv[1] == "rows":
    check_rows(sys.argv[2], sys.argv[3])
elif sys.argv[1] == "damage":
    check_damage(sys.argv[2], sys.argv[3])
else:
    sys.exit(__doc__)
