# SPDX-License-Identifier: Apache-2.0
"""Compares the name that the tool suggests for a wrong word with the nearest by
an edit distance that is written here.

usage: nearest.py DRAPE
"""
import random
import re
import subprocess
import sys


def distance(a, b):
    """Levenshtein's, by recursion on the first letters."""
    known = {}

    def rest(i, j):
        if i == len(a) or j == len(b):
            return len(a) - i + len(b) - j
        if (i, j) not in known:
            known[i, j] = rest(i + 1, j + 1) if a[i] == b[j] else 1 + min(
                rest(i + 1, j + 1), rest(i + 1, j), rest(i, j + 1))
        return known[i, j]
    return rest(0, 0)


def damaged(name, edits, chance):
    """A name after this many edits."""
    for _ in range(edits):
        k, letter = chance.randrange(len(name)), chance.choice('aeknrutv')
        name = chance.choice([name[:k] + letter + name[k:],
                              name[:k] + name[k + 1:],
                              name[:k] + letter + name[k + 1:]]) or letter
    return name


def expected(word, names):
    """The first of the nearest, within two edits and not all of its letters."""
    least = min(distance(word, n) for n in names)
    near = [n for n in names if distance(word, n) == least]
    return near[0] if least <= 2 and least < len(near[0]) else None


def check(drape, start, names, words):
    """Of how many words a suggestion was made."""
    count = 0
    for word in words:
        said = subprocess.run([drape, *start, word], capture_output=True,
                              text=True)
        assert said.returncode == 2, (word, said)
        found = re.search(r'did you mean (\S+)\?', said.stderr)
        found = found.group(1) if found else None
        assert found == expected(word, names), (word, found)
        count += found is not None
    return count


def main():
    drape, chance = sys.argv[1], random.Random(1)
    usage = subprocess.run([drape, 'help'], capture_output=True, text=True)
    names = re.findall(r'^  ([a-z][a-z-]*) ', usage.stdout, re.M)
    assert len(names) == 16, names
    words = {damaged(n, k, chance) for n in names for k in (1, 1, 2, 3)}
    words = sorted(w for w in words if w not in names) + ['x' * 40, 'vvvv']
    count = check(drape, [], names + ['--version'], words)
    assert 15 < count < len(words), (count, len(words))
    # one edit from --obj, and two from --out, which stands before it
    assert check(drape, ['run', 'tiny.json'], ['--out', '--obj'], ['--okj']) == 1


main()
