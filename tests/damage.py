# SPDX-License-Identifier: Apache-2.0
"""Damages small files and sees that the tool survives them.

usage: tests/damage.py DRAPE FOLDER [RUNS [SEED]]; ends with `N files, N
wrong`. Each file of the folder is cut off at places and has bits, numbers and
pieces changed, the same ones for one seed; RUNS 0 cuts it off at every byte
instead. Whatever is left of it, the tool
ends by itself, with exit status 0 to 3, within a time, and says at most one
line on standard error, which is there where the status is not 0. What is
wrong stays in FOLDER.wrong.
"""
import os
import random
import subprocess
import sys
import tempfile

drape, folder = os.path.abspath(sys.argv[1]), sys.argv[2]
runs = int(sys.argv[3]) if len(sys.argv) > 3 else 12
chance = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
NUMBERS = [b"-1", b"0", b"9", b"0.5", b"1e999", b"nan", b"4294967296",
           b"99999999999999999999", b""]
SECONDS = 60


def command(path):
    """How the tool is asked to read the file."""
    kind = path.rsplit(".", 1)[1]
    if kind == "json":
        return ["plan", path]
    if kind == "csv":
        return ["ccd", "--kind", "ee", path]
    return ["convert", path, path + ".out.ply"]


def digits(data):
    """Where numbers begin and end in a text."""
    places, start = [], None
    for k, c in enumerate(data + b" "):
        inside = chr(c) in "0123456789.-+e"
        if inside and start is None:
            start = k
        if not inside and start is not None:
            places.append((start, k))
            start = None
    return places


def damage(data):
    data = bytearray(data)
    kind = chance.randrange(5)
    if kind == 0:
        return data[:chance.randrange(len(data))]
    if kind == 1:
        for _ in range(chance.choice([1, 1, 2, 8])):
            data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    if kind == 2:
        a = chance.randrange(len(data))
        del data[a:a + chance.choice([1, 2, 8, 40])]
    if kind == 3:
        a, b = sorted(chance.randrange(len(data)) for _ in range(2))
        data[b:b] = data[a:min(b, a + 200)]
    if kind == 4:
        a, b = chance.choice(digits(bytes(data)) or [(0, 1)])
        data[a:b] = chance.choice(NUMBERS)
    return data


def fault(path):
    """What is wrong with the tool's answer, or None."""
    try:
        done = subprocess.run([drape, *command(path)], capture_output=True,
                              stdin=subprocess.DEVNULL, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "no end"
    lines = done.stderr.count(b"\n")
    if not 0 <= done.returncode <= 3:
        return f"status {done.returncode}"
    # A scene's degenerate triangles are told of where all is well.
    if lines > 1 or (done.returncode > 0 and lines != 1):
        return f"status {done.returncode}, {lines} lines: {done.stderr[:200]}"
    return None


def main():
    wrong = count = 0
    names = sorted(os.listdir(folder))
    with tempfile.TemporaryDirectory() as work:
        for name in names:
            with open(os.path.join(folder, name), "rb") as file:
                whole = file.read()
            for k in range(runs or len(whole)):
                data = damage(whole) if runs else whole[:k]
                path = os.path.join(work, name)
                with open(path, "wb") as file:
                    file.write(data)
                count += 1
                why = fault(path)
                if why:
                    wrong += 1
                    print(f"not ok {name} {k}: {why}")
                    os.makedirs(folder + ".wrong", exist_ok=True)
                    with open(os.path.join(folder + ".wrong",
                                           f"{k}_{name}"), "wb") as file:
                        file.write(data)
    print(f"{count} files, {wrong} wrong")
    sys.exit(wrong > 0 or count == 0)


main()
