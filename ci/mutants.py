#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing: plants faults one by one and reports which checks find
them.

usage: mutants.py [-n 60] [--seed 1] [--skip 0] [--all | --base REV]
                  [--kind ref,gpu,both,app] [--match RE] [--quick]
                  [--work DIR] [--costs FILE] [--jobs 2] [--list]

A mutant changes one token, statement or pair of arguments in a line of ref/,
gpu/ or app/, or in a line of ref/ and in the equal lines of its twin in gpu/
(`both`): a comparison of the two backends cannot find such a fault. By default
mutants are made in the lines that the working tree or the commits since --base
changed (if there are none, in those of the last commit); with --all in any
line. --skip leaves out those that a run before has judged. A mutant does not
count if its objects equal the base's byte for byte, if
it does not compile, or if ci/mutants.equivalent argues that it is equivalent.

Every check runs first on the unchanged tree, which must pass it; --costs names
a file that has the seconds of each check from a run before, or gets them. Checks
of a mutant run from the fastest on, and one that takes five times as long as there,
and 20 s, counts as found: it hangs. The recorded hashes run last: they show
that bits changed, not that the change is wrong, so a mutant that they alone
find is not killed.
"""
import argparse
import filecmp
import glob
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from mutate import mutants_of, twins_of

# Files of gpu/ that emulation replaces, or that are the emulation, and examples,
# which the tool does not hold.
ABSENT = re.compile(r'app/examples/|gpu/\w+/(emulate.*|(blas|cublas|device|loop|prim|stream|trace|'
                    r'absent)\.\w+|.*\.h|bulk\.cuh)$')


# Which lines to mutate

def git(*args):
    return subprocess.run(['git', *args], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def changed_lines(base):
    """Lines by file, from 0, that differ from a revision."""
    lines, path = {}, None
    for row in git('diff', '-U0', base, '--', 'ref', 'gpu', 'app').splitlines():
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


# Building and checking

class Workshop:
    def __init__(self, work, jobs):
        self.base, self.tree = f'{work}/base', f'{work}/tree'
        self.log, self.jobs = f'{work}/log', jobs
        self.env = dict(os.environ, OMP_NUM_THREADS='1', GPU='',
                        OMP_WAIT_POLICY='passive', DRAPE_FAILURES=work)
        os.makedirs(self.base, exist_ok=True)
        for f in git('ls-files').splitlines():
            self.take(f)
        self.cwd = self.base
        if self.run(['git', 'init', '-q'], 60) or self.make(''):
            sys.exit(f'mutants: the tree does not build: see {self.log}')
        self.cost = {}
        shutil.rmtree(self.tree, ignore_errors=True)
        shutil.copytree(self.base, self.tree, symlinks=True)
        self.cwd = self.tree

    def take(self, f):
        """A file of the checkout to the base, unless it is there."""
        there = f'{self.base}/{f}'
        if not os.path.exists(f):
            return
        if os.path.exists(there) and filecmp.cmp(f, there, shallow=False):
            return
        os.makedirs(os.path.dirname(there), exist_ok=True)
        shutil.copy(f, there)

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
        return self.run(['make', '-s', f'-j{self.jobs}', 'GPU=',
                         flags or 'SAN=', 'build/check', 'build/drape'], 1800)

    def measure(self, commands, costs):
        """The seconds that each check takes on the base, which must pass it."""
        if costs and os.path.exists(costs):
            self.cost = {tuple(c): s for c, s in json.load(open(costs))}
            return
        self.cwd = self.base
        for command in commands:
            start = resource.getrusage(resource.RUSAGE_CHILDREN)
            why = self.failed(command, 600)
            if why:
                sys.exit(f'mutants: {" ".join(command)} fails without a '
                         f'fault: {why}')
            end = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.cost[tuple(command)] = end.ru_utime + end.ru_stime - \
                start.ru_utime - start.ru_stime
        self.cwd = self.tree
        if costs:
            with open(costs, 'w') as out:
                json.dump(list(self.cost.items()), out)

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
        """Whether what was compiled anew is the base's, byte for byte, but for
        the objects that hold the digests of the code: these always differ."""
        for part in ('ref/*', 'gpu/*', 'tests/*', 'app/*'):
            for a in glob.glob(f'{self.base}/build/{part}/*.o'):
                b = self.tree + a[len(self.base):]
                with open(a[:-1] + 'd') as needs:
                    digests = 'certificate.h' in needs.read()
                if not digests and not filecmp.cmp(a, b, shallow=False):
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


CHECK = 'build/check'
PROVE = ['sh', 'ci/prove.sh']
GOLDEN = [CHECK, '--plain', '--golden', 'tests/golden/stages.txt']
# The tool's tests, to the first that fails.
TOOL = ['sh', '-c', 'sh tests/app.sh build/drape | awk '
        "'{ print; last = $0 } /^not ok/ { bad = 1; exit } "
        "END { exit bad || last !~ / 0 failed/ }'"]


def every_check(quick):
    """All checks, as commands."""
    found = [[CHECK, '--stages'], [CHECK, '--gpu'], PROVE, GOLDEN]
    if quick:
        return found
    tests = re.findall(r'^TEST\((\w+)\)', open('tests/tests.def').read(), re.M)
    return found + [[CHECK, '--tests', '--only', t] for t in tests] + [TOOL]


def checks(mutant, cost):
    """The checks that can see a mutant, each with the seconds that it takes at
    most: those named after its files, then the others, the fastest first."""
    if mutant.kind == 'app':
        return [(TOOL, cost[tuple(TOOL)])] if tuple(TOOL) in cost else []
    stems = {os.path.splitext(os.path.basename(f))[0]
             for f, _, _ in mutant.changes}
    stages = re.findall(r'^STAGE\(\w+, \w+, (\w+),',
                        open('spec/stages.def').read(), re.M)
    found = [([CHECK, how, '--only', s], cost[CHECK, how])
             for s in sorted(stems & set(stages))
             for how in ('--stages', '--gpu')]
    constant = any('0x1p' in e.what or 'define' in mutant.text
                   for _, _, e in mutant.changes)
    skip = [GOLDEN] + ([] if constant else [PROVE]) + \
        ([TOOL, [CHECK, '--stages']] if mutant.kind == 'gpu' else [])
    rest = [(list(c), s) for c, s in cost.items() if list(c) not in skip]

    def order(c):
        near = c[0][1] == '--tests' and any(map(c[0][3].startswith, stems))
        return not near, c[1]
    return found + sorted(rest, key=order)


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
    for command, seconds in checks(mutant, shop.cost):
        why = shop.failed(command, 20 + int(5 * seconds))
        if why:
            return f'killed: {" ".join(command[1:])}: {why}'
    return 'only golden' if shop.failed(GOLDEN, 300) else 'SURVIVED'


def arguments():
    p = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    p.add_argument('-n', type=int, default=60)
    p.add_argument('--seed', type=int, default=1)
    p.add_argument('--skip', type=int, default=0)
    p.add_argument('--all', action='store_true')
    p.add_argument('--base', default='')
    p.add_argument('--kind', default='ref,gpu,both,app')
    p.add_argument('--match', default='')
    p.add_argument('--quick', action='store_true')
    p.add_argument('--work', default='build/mutants')
    p.add_argument('--costs', default='')
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
    files = [f for f in git('ls-files', 'ref', 'gpu', 'app').splitlines()
             if f.endswith(('.c', '.h', '.cu', '.cuh')) and
             not ABSENT.match(f)]
    sources = {f: open(f).read() for f in files}
    lines = None if a.all else changed_lines(base_of(a.base))
    found = [m for m in all_mutants(sources, a.kind.split(','), lines)
             if re.search(a.match, m.changes[0][2].what)]
    chosen = sample(found, a.n, a.seed)[a.skip:]
    known = equivalents('ci/mutants.equivalent')
    if a.list or not chosen:
        for m in chosen:
            print(m.name())
        print(f'{len(chosen)} mutants')
        return 0
    shop = Workshop(os.path.abspath(a.work), a.jobs)
    shop.measure(every_check(a.quick), a.costs)
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
