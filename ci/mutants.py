#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants faults one by one and says which checks see them.

usage: mutants.py [-n 60] [--seed 1] [--all | --base REV] [--kind ref,gpu,both]
                  [--work DIR] [--jobs 2] [--list]

A mutant is one token, statement or pair of arguments changed in a line of ref/
or gpu/, or in a line of ref/ and in the lines of its twin in gpu/ that read
alike (`both`): what compares the two cannot see those. By default lines that
the working tree or the commits since --base changed are mutated (none: those of
the last commit); --all: any. A mutant whose objects are the base's, byte for
byte, is equal and does not count; nor does one that does not compile, or that
ci/mutants.equivalent argues to be equivalent. Checks run from the fastest on,
and a hang is a kill. Recorded hashes run last: they see that something changed,
not that it is wrong, so what they alone see has not been killed.
"""
import argparse
import filecmp
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

TOKEN = re.compile(r'''
    (?P<skip>//[^\n]*|/\*.*?\*/|\s+|\\\n)
  | (?P<preproc>^[ \t]*\#(?:[^\n\\]|\\\n|\\.)*)
  | (?P<text>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
  | (?P<number>(?:0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|\.?\d[\w.]*(?:(?<=[eE])[+-]\d+)?))
  | (?P<name>[A-Za-z_]\w*)
  | (?P<op><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|[<>=!+\-*/%&|^]=|&&|\|\||::|.)
''', re.X | re.S | re.M)
SWAPS = {'+': '-', '-': '+', '*': '/', '/': '*', '%': '/', '&&': '||',
         '||': '&&', '+=': '-=', '-=': '+=', '++': '--', '--': '++',
         '<': '<=', '<=': '<', '>': '>=', '>=': '>', '==': '!=', '!=': '==',
         '<<': '>>', '>>': '<<', '&': '|', '|': '&', '|=': '='}
TURNS = {'<': '>=', '>=': '<', '>': '<=', '<=': '>'}
WORDS = {'true': 'false', 'false': 'true', 'break': 'continue',
         'least': 'most', 'most': 'least', 'real_min': 'real_max',
         'real_max': 'real_min', 'vec_min': 'vec_max', 'vec_max': 'vec_min',
         'add': 'sub', 'sub': 'add', 'vec_add': 'vec_sub',
         'vec_sub': 'vec_add'}
TWIN = re.compile(r'^(?:ref|gpu|vec|real|sym)_')
# Of gpu/, what emulation replaces or is.
ABSENT = re.compile(r'gpu/(emulate.*|(blas|cublas|device|loop|prim|reel|trace|'
                    r'absent)\.\w+|.*\.h|bulk\.cuh)$')


class Token:
    def __init__(self, kind, text, at, line):
        self.kind, self.text, self.at, self.line = kind, text, at, line


def tokens(source):
    found, line = [], 1
    for m in TOKEN.finditer(source):
        if m.lastgroup != 'skip':
            found.append(Token(m.lastgroup, m.group(), m.start(), line))
        line += m.group().count('\n')
    return found


class Edit:
    """One change: source[at:end] becomes new."""

    def __init__(self, line, at, end, new, what, key):
        self.line, self.at, self.end, self.new = line, at, end, new
        self.what, self.key = what, key


def is_value(t):
    return t.kind in ('name', 'number') or t.text in (')', ']')


def number_edits(t):
    m = re.fullmatch(r'(0x1)p([+-]?\d+)', t.text)
    if m:
        e = int(m.group(2))
        return [f'{m.group(1)}p{e - 2}', f'{m.group(1)}p{e + 2}']
    if re.fullmatch(r'\d+', t.text):
        n = int(t.text)
        return [str(n + 1), str(n - 1)] if n > 0 else ['1']
    if re.fullmatch(r'\d*\.\d+(?:e-?\d+)?', t.text):
        return [repr(float(t.text) * 2), repr(float(t.text) / 2)]
    return []


def token_edits(ts, k, source):
    t = ts[k]
    new = []
    if t.kind == 'op' and t.text in SWAPS and 0 < k < len(ts) - 1:
        # a binary operator has spaces around it, as clang-format puts them
        binary = source[t.at + len(t.text)].isspace() and is_value(ts[k - 1])
        if binary or t.text in ('++', '--'):
            new = [SWAPS[t.text]]
            new += [TURNS[t.text]] if t.text in TURNS else []
        elif t.text == '-':
            new = ['']
    elif t.text == '!':
        new = ['']
    elif t.kind == 'name' and t.text in WORDS:
        new = [WORDS[t.text]]
    elif t.kind == 'number':
        new = number_edits(t)
    end = t.at + len(t.text)
    return [Edit(t.line, t.at, end, n, f'{t.text} -> {n or "nothing"}',
                 (k, n)) for n in new]


def close(ts, k):
    """The token that closes the bracket at k, or None."""
    depth = 0
    for j in range(k, len(ts)):
        depth += ts[j].text in ('(', '[', '{')
        depth -= ts[j].text in (')', ']', '}')
        if depth == 0:
            return j
    return None


def declares(ts, a, b):
    """Whether the tokens from a to b are a type and a name."""
    return any(ts[k].kind == ts[k + 1].kind == 'name' for k in range(a, b)) or \
        b > a + 1 and ts[a].kind == 'name' and ts[a + 1].text == '*' and \
        ts[b].at == ts[b - 1].at + 1


def swap_edits(ts, k, source):
    """Two neighbours among the arguments of a call that opens at k."""
    if ts[k].text != '(' or k == 0 or ts[k - 1].kind != 'name':
        return []
    end = close(ts, k)
    if end is None or ts[k - 1].text in ('if', 'for', 'while', 'switch'):
        return []
    args, start, depth = [], k + 1, 0
    for j in range(k + 1, end + 1):
        depth += ts[j].text in ('(', '[', '{')
        depth -= ts[j].text in (')', ']', '}') and j < end
        if (ts[j].text == ',' and depth == 0) or j == end:
            args.append((start, j - 1))
            start = j + 1
    edits = []
    for (a, b), (c, d) in zip(args, args[1:]):
        if b < a or d < c:
            continue
        at, cut = ts[a].at, ts[b].at + len(ts[b].text)
        again, stop = ts[c].at, ts[d].at + len(ts[d].text)
        one, two = source[at:cut], source[again:stop]
        alike = ts[a].kind == ts[c].kind and (ts[a].kind != 'op' or
                                              ts[a].text == ts[c].text)
        if one != two and alike and not declares(ts, a, b) and \
                not declares(ts, c, d):
            edits.append(Edit(ts[a].line, at, stop,
                              two + source[cut:again] + one,
                              f'arguments swapped: {one}, {two}', (a, 'swap')))
    return edits


def drop_edits(ts, k, source):
    """The statement that begins at k, if it is no declaration."""
    starts = k and (ts[k - 1].text in (';', '{', '}', ')', ':', 'else') or
                    ts[k - 1].kind == 'preproc')
    if not starts or k + 1 >= len(ts) or \
            ts[k].kind != 'name' and ts[k].text != '*':
        return []
    first, follow = ts[k].text, ts[k + 1]
    if first in ('if', 'for', 'while', 'do', 'switch', 'case', 'else',
                 'static', 'struct', 'enum', 'default', 'typedef', 'template',
                 'const', 'UNROLL', 'extern'):
        return []
    if first == 'return' and follow.text != ';' or follow.kind == 'name':
        return []
    end, depth = k, 0
    while end < len(ts) and not (ts[end].text == ';' and depth == 0):
        depth += ts[end].text in ('(', '[', '{')
        depth -= ts[end].text in (')', ']', '}')
        if depth < 0:
            return []
        end += 1
    if end >= len(ts):
        return []
    does = any(t.text in ('(', '=', '++', '--', '+=', '-=', '|=', '*=', '&=')
               for t in ts[k:end])
    if not does and first not in ('break', 'continue', 'return') or \
            ts[k].kind == 'name' and follow.text == '*':
        return []
    at, stop = ts[k].at, ts[end].at
    what = ' '.join(source[at:stop].split())
    return [Edit(ts[k].line, at, stop, '', f'dropped: {what}', (k, 'drop'))]


def edits_of(source):
    ts = tokens(source)
    found, depth = [], 0
    for k, t in enumerate(ts):
        depth += t.text == '{'
        depth -= t.text == '}'
        if t.kind == 'preproc':
            m = re.match(r'\s*#define \w+ (0x1p[+-]?\d+|\d+)\b', t.text)
            for new in number_edits(Token('number', m.group(1), 0, 0)) \
                    if m else []:
                at = t.at + m.start(1)
                found.append(Edit(t.line, at, at + len(m.group(1)), new,
                                  f'{m.group(1)} -> {new}', (k, new)))
        elif depth > 0:
            found += token_edits(ts, k, source) + swap_edits(ts, k, source)
            found += drop_edits(ts, k, source)
    return found


# ---- Twins ----

def normal(line):
    """The tokens of a line, as they read alike in ref/ and in gpu/."""
    drop = ('__device__', 'static', 'inline', '(real)')
    return tuple(TWIN.sub('', t.text) for t in tokens(line)
                 if t.text not in drop)


def line_edits(line):
    """What can be changed in a line taken alone, by place and change."""
    ts = tokens(line)
    found = {}
    for k in range(len(ts)):
        if ts[k].kind == 'preproc':
            continue
        for e in token_edits(ts, k, line) + swap_edits(ts, k, line) + \
                (drop_edits([Token('op', ';', -1, 0)] + ts, k + 1, line)
                 if k == 0 else []):
            found[(k, TWIN.sub('', e.key[1]))] = e
    return found


def twins_of(ref, sources):
    """Mutants of a file of ref/ and of the lines of gpu/ that read like it."""
    stem = os.path.splitext(os.path.basename(ref))[0]
    files = [f for f in sources if f.startswith('gpu/') and
             os.path.splitext(os.path.basename(f))[0] == stem]
    theirs = {}
    for f in files:
        for n, line in enumerate(sources[f].splitlines(keepends=True)):
            theirs.setdefault(normal(line), []).append((f, n))
    mine, code = {}, {t.line - 1 for t in tokens(sources[ref])}
    for n, line in enumerate(sources[ref].splitlines(keepends=True)):
        if n in code:  # and no comment
            mine.setdefault(normal(line), []).append(n)
    mutants = []
    for key, lines in mine.items():
        there = theirs.get(key, [])
        if len(key) < 5 or len(lines) != 1 or len(there) != 1:
            continue
        here = sources[ref].splitlines(keepends=True)[lines[0]]
        f, n = there[0]
        other = line_edits(sources[f].splitlines(keepends=True)[n])
        for place, e in line_edits(here).items():
            if place in other:
                mutants.append(Mutant('both', [(ref, lines[0], e),
                                               (f, n, other[place])], here))
    return mutants


class Mutant:
    """Changes of lines: (file, line from 0, edit whose places are in it)."""

    def __init__(self, kind, changes, text):
        self.kind, self.changes, self.text = kind, changes, text.strip()

    def name(self):
        where = ', '.join(f'{f}:{n + 1}' for f, n, _ in self.changes)
        return f'{self.kind} {where}: {self.changes[0][2].what}'

    def apply(self, sources):
        """The changed files: name, text."""
        for f, n, e in self.changes:
            source = sources[f]
            at = 0
            if n >= 0:
                lines = source.splitlines(keepends=True)
                at = sum(map(len, lines[:n]))
            yield f, source[:at + e.at] + e.new + source[at + e.end:]


def mutants_of(path, sources):
    lines = sources[path].splitlines()
    kind = path.split('/')[0]
    for e in edits_of(sources[path]):
        start = sum(len(x) + 1 for x in lines[:e.line - 1])
        moved = Edit(e.line, e.at - start, e.end - start, e.new, e.what, e.key)
        yield Mutant(kind, [(path, e.line - 1, moved)], lines[e.line - 1])


# ---- What to mutate ----

def git(*args):
    return subprocess.run(['git', *args], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def changed_lines(base):
    """Lines by file, from 0, that differ from a revision."""
    lines, path = {}, None
    for row in git('diff', '-U0', base, '--', 'ref', 'gpu').splitlines():
        if row.startswith('+++ '):
            path = row[6:]
        m = re.match(r'@@ -\S+ \+(\d+)(?:,(\d+))? @@', row)
        if m:
            n = int(m.group(1)) - 1
            lines.setdefault(path, set()).update(
                range(n, n + int(m.group(2) or 1)))
    return lines


def all_mutants(sources, kinds, lines):
    found = []
    for path in sources:
        if path.split('/')[0] in kinds:
            found += mutants_of(path, sources)
        if 'both' in kinds and path.startswith('ref/'):
            found += twins_of(path, sources)
    if lines is not None:
        found = [m for m in found
                 if any(n in lines.get(f, ()) for f, n, _ in m.changes)]
    return found


def sample(found, n, seed):
    """n of them, as many of each kind, no two of a line."""
    random.Random(seed).shuffle(found)
    seen, by = set(), {}
    for m in found:
        places = {(f, k) for f, k, _ in m.changes}
        if not places & seen:
            seen |= places
            by.setdefault(m.kind, []).append(m)
    chosen = []
    while len(chosen) < n and any(by.values()):
        for kind in by:
            if by[kind] and len(chosen) < n:
                chosen.append(by[kind].pop())
    return chosen


def equivalents(path):
    """Rows file | line | change | reason."""
    known = {}
    if os.path.exists(path):
        for row in open(path):
            if row.strip() and not row.startswith('#'):
                f, text, what, why = (x.strip() for x in row.split(' | ', 3))
                known[(f, text, what)] = why
    return known


# ---- Building and checking ----

class Workshop:
    def __init__(self, work, jobs):
        self.base, self.tree = f'{work}/base', f'{work}/tree'
        self.log, self.jobs = f'{work}/log', jobs
        self.env = dict(os.environ, OMP_NUM_THREADS='1', GPU='',
                        OMP_WAIT_POLICY='passive', DRAPE_FAILURES=work)
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(self.base)
        for f in git('ls-files').splitlines():
            if os.path.exists(f):
                os.makedirs(os.path.dirname(f'{self.base}/{f}') or '.',
                            exist_ok=True)
                shutil.copy2(f, f'{self.base}/{f}')
        self.cwd = self.base
        if self.run(['git', 'init', '-q'], 60) or self.make(''):
            sys.exit(f'mutants: the tree does not build: see {self.log}')
        shutil.copytree(self.base, self.tree, symlinks=True)
        self.cwd = self.tree

    def run(self, command, limit):
        """The exit status, 124 after `limit` seconds of a processor or ten
        times as long; output to the log."""
        def bound():
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        with open(self.log, 'w') as log:
            p = subprocess.Popen(['nice', '-n', '10', *command], cwd=self.cwd,
                                 stdout=log, stderr=log, env=self.env,
                                 start_new_session=True, preexec_fn=bound)
            try:
                status = p.wait(10 * limit)
            except subprocess.TimeoutExpired:
                os.killpg(p.pid, signal.SIGKILL)
                p.wait()
                return 124
            return 124 if status in (-signal.SIGXCPU, -signal.SIGKILL) \
                else status

    def make(self, flags='SAN=-w'):
        return self.run(['make', '-s', f'-j{self.jobs}', 'GPU=', flags or 'SAN=',
                         'build/check'], 1800)

    def restore(self):
        """The tree is the base again, with its times."""
        for root, dirs, files in os.walk(self.tree):
            dirs[:] = [d for d in dirs if d != '.git']
            for f in files:
                mine = os.path.join(root, f)
                theirs = self.base + mine[len(self.tree):]
                if not os.path.exists(theirs):
                    os.remove(mine)
                elif os.stat(mine).st_mtime_ns != os.stat(theirs).st_mtime_ns:
                    shutil.copy2(theirs, mine)

    def same_objects(self):
        """Whether what was compiled anew is the base's, byte for byte."""
        for part in ('ref', 'gpu', 'tests'):
            for f in os.listdir(f'{self.base}/build/{part}'):
                a = f'{self.base}/build/{part}/{f}'
                b = f'{self.tree}/build/{part}/{f}'
                if f.endswith('.o') and not filecmp.cmp(a, b, shallow=False):
                    return False
        return True

    def failed(self, command, limit):
        """NULL, or the first thing that it says is wrong."""
        status = self.run(command, limit)
        if status == 0:
            return None
        with open(self.log, errors='replace') as log:
            said = [x.strip() for x in log
                    if re.match(r'FAILED|emulate:|not ok', x)]
        return said[0] if said else \
            'a hang' if status == 124 else f'exit {status}'


# Slowest last; these by themselves, before all others, find most.
SLOW = ('embed_lost', 'embed_memory', 'embed_lent', 'fused', 'motion_device',
        'tape', 'narrow_soak')


def checks(mutant):
    """Name, command, limit in seconds, from the fastest on."""
    check = 'build/check'
    stems = {os.path.splitext(os.path.basename(f))[0]
             for f, _, _ in mutant.changes}
    stages = re.findall(r'^STAGE\((\w+),', open('spec/stages.def').read(), re.M)
    tests = re.findall(r'^TEST\((\w+)\)', open('tests/tests.def').read(), re.M)
    for s in sorted(stems & set(stages)):
        yield [check, '--stages', '--only', s], 60
        yield [check, '--gpu', '--only', s], 120
    if any('0x1p' in e.what or 'define' in mutant.text
           for _, _, e in mutant.changes):
        yield ['sh', 'ci/prove.sh'], 120
    if mutant.kind != 'gpu':
        yield [check, '--stages'], 120
    yield [check, '--gpu'], 300
    near = [t for t in tests if any(t.startswith(s) for s in stems)]
    rest = [t for t in tests if t not in near]
    rest.sort(key=lambda t: t in SLOW and 1 + SLOW.index(t))
    for t in near + rest:
        yield [check, '--tests', '--only', t], 300


def judge(shop, mutant, sources):
    """equal, invalid, killed by …, only golden, or SURVIVED."""
    shop.restore()
    for f, text in mutant.apply(sources):
        with open(f'{shop.tree}/{f}', 'w') as out:
            out.write(text)
    if shop.make():
        return 'invalid'
    if shop.same_objects():
        return 'equal'
    for command, limit in checks(mutant):
        why = shop.failed(command, limit)
        if why:
            return f'killed: {" ".join(command[1:])}: {why}'
    golden = ['build/check', '--plain', '--golden', 'tests/golden/stages.txt']
    return 'only golden' if shop.failed(golden, 300) else 'SURVIVED'


def arguments():
    p = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    p.add_argument('-n', type=int, default=60)
    p.add_argument('--seed', type=int, default=1)
    p.add_argument('--all', action='store_true')
    p.add_argument('--base', default='')
    p.add_argument('--kind', default='ref,gpu,both')
    p.add_argument('--work', default='build/mutants')
    p.add_argument('--jobs', type=int, default=2)
    p.add_argument('--list', action='store_true')
    return p.parse_args()


def base_of(given):
    """The revision that changes are counted from."""
    if given:
        return given
    upstream = subprocess.run(['git', 'merge-base', 'HEAD', 'origin/main'],
                              text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL).stdout.strip()
    lone = not upstream or not git('diff', '--name-only', upstream)
    return 'HEAD~1' if lone else upstream


def main():
    a = arguments()
    files = [f for f in git('ls-files', 'ref', 'gpu').splitlines()
             if f.endswith(('.c', '.h', '.cu', '.cuh')) and
             not ABSENT.match(f)]
    sources = {f: open(f).read() for f in files}
    lines = None if a.all else changed_lines(base_of(a.base))
    chosen = sample(all_mutants(sources, a.kind.split(','), lines), a.n, a.seed)
    known = equivalents('ci/mutants.equivalent')
    if a.list or not chosen:
        for m in chosen:
            print(m.name())
        print(f'{len(chosen)} mutants')
        return 0
    shop = Workshop(os.path.abspath(a.work), a.jobs)
    tally, left = {}, []
    for m in chosen:
        f, _, e = m.changes[0]
        start = time.time()
        how = judge(shop, m, sources)
        if (f, m.text, e.what) in known and not how.startswith('killed'):
            how = 'argued equivalent'
        word = how.split(':')[0]
        tally[word] = tally.get(word, 0) + 1
        if word in ('SURVIVED', 'only golden'):
            left.append(m)
        print(f'{m.name()}\n    {how} ({time.time() - start:.0f} s)',
              flush=True)
    killed = tally.get('killed', 0)
    print('; '.join(f'{n} {w}' for w, n in sorted(tally.items())))
    for m in left:
        print(f'left: {m.name()}   {m.text}')
    count = killed + len(left)
    print(f'score: {killed} of {count}, '
          f'{100 * killed / max(count, 1):.0f} %')
    return 0 if killed >= 0.95 * count else 1


if __name__ == '__main__':
    sys.exit(main())
