# SPDX-License-Identifier: Apache-2.0
"""The pairs that `drape ccd --frames` prints, asked one by one.

usage: touches.py DRAPE
A soup of triangles moves through itself. Each pair that is printed is in its normal
form and touches if it is asked for alone; of those that are not printed some are
asked, and none touches.
"""
import itertools
import random
import subprocess
import sys

TRIANGLES = 50


def put(path, x):
    with open(path, "w") as file:
        file.write("OFF\n%d %d 0\n" % (len(x), TRIANGLES))
        file.writelines("%d %d %d\n" % p for p in x)
        file.writelines("3 %d %d %d\n" % (3 * k, 3 * k + 1, 3 * k + 2)
                        for k in range(TRIANGLES))


def ask(drape, kind, queries, x, y):
    """Whether each of these pairs touches, by the queries of a file."""
    with open("asked.csv", "w") as file:
        for v in queries:
            for at in (x, y):
                file.writelines("%d,1,%d,1,+%d,+1\n" % at[k] for k in v)
    done = subprocess.run([drape, "ccd", "--kind", kind, "asked.csv"],
                          capture_output=True, text=True, check=True)
    return [line[0] == "1" for line in done.stdout.splitlines()]


def check_normal(rows):
    assert rows == sorted(rows, key=lambda r: (r[0] == "ee", r[1])), "order"
    assert len(rows) == len({(kind, *v) for kind, v in rows}), "a pair twice"
    for kind, v in rows:
        assert kind == "vf" or v[0] < v[1] and v[2] < v[3] and v[0] < v[2], v


def main():
    drape, chance = sys.argv[1], random.Random(1)
    n = 3 * TRIANGLES
    x = [tuple(chance.randrange(60) for _ in range(3)) for _ in range(n)]
    y = [tuple(a + chance.randrange(-9, 10) for a in p[:2]) + (60 - p[2],) for p in x]
    put("x.off", x)
    put("y.off", y)
    done = subprocess.run([drape, "ccd", "--frames", "x.off", "y.off"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [(r[0], [int(v) for v in r[1:]])
            for r in map(str.split, done.stdout.splitlines())]
    check_normal(rows)
    assert len(rows) > 2048 and done.stderr.endswith(", %d touch\n" % len(rows))
    faces = [[3 * k, 3 * k + 1, 3 * k + 2] for k in range(TRIANGLES)]
    edges = [[f[a], f[b]] for f in faces for a, b in ((0, 1), (1, 2), (0, 2))]
    every = {"vf": [[v, *f] for v in range(n) for f in faces if v not in f],
             "ee": [a + b for a, b in itertools.combinations(edges, 2)
                    if not set(a) & set(b)]}
    for kind, pairs in every.items():
        told = {tuple(v) for k, v in rows if k == kind}
        assert told and told < {tuple(v) for v in pairs}, kind
        some = [v for v in pairs if tuple(v) in told or chance.random() < 0.2]
        for v, touches in zip(some, ask(drape, kind, some, x, y)):
            assert touches == (tuple(v) in told), (kind, v)


main()
