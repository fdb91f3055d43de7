#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fuzzes targets in turn for as long as there is, and adds their hours to a record:
one minute a target, those that have run least first, as many at once as there are
processors. What ends it, a signal too, leaves the record right, so that a soak goes
on where the last one stopped. A crash leaves its input, BUILD/fuzz/TARGET-crash-….

usage: ci/soak.py BUILD SECONDS RECORD.csv [TARGET... | --turn]

ci/fuzz.sh builds BUILD/fuzz/TARGET and unpacks BUILD/corpus beforehand. --turn takes
the targets whose turn it is at this commit: so CI, which forgets what it has run,
comes to each.
"""
import csv
import os
import re
import signal
import subprocess
import sys
import time

SLICE = 60  # s of one target, before the next has its turn
LIMITS = ["-max_len=8192", "-timeout=300", "-rss_limit_mb=4096",
          "-close_fd_mask=3", "-print_final_stats=1"]
HEAD = ["target", "seconds", "executions", "crashes"]


class Record:
    """What each target has run so far, in a file; sorted as the targets are."""

    def __init__(self, path, targets):
        self.path = path
        self.rows = {target: [0, 0, 0] for target in targets}
        if os.path.exists(path):
            with open(path, encoding="utf-8", newline="") as file:
                for row in csv.DictReader(file):
                    self.rows[row["target"]] = [int(row[key]) for key in HEAD[1:]]

    def add(self, target, *counts):
        """Adds to a target's row, and replaces the file by a whole one."""
        self.rows[target] = [a + b for a, b in zip(self.rows[target], counts)]
        part = self.path + ".part"
        with open(part, "w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(HEAD)
            table.writerows([name, *row] for name, row in self.rows.items())
        os.replace(part, self.path)


def of_this_turn(targets, count):
    """The next `count` targets: each commit on the line of first parents takes as
    many as there is time for. Where the clone is shallow its name decides."""
    def git(*words):
        return subprocess.run(["git", *words], check=True, text=True,
                              stdout=subprocess.PIPE).stdout.strip()
    if git("rev-parse", "--is-shallow-repository") == "true":
        turn = int(git("rev-parse", "HEAD")[:8], 16)
    else:
        turn = int(git("rev-list", "--count", "--first-parent", "HEAD"))
    first = turn * count % len(targets)
    return (targets + targets)[first:first + count]


class Soak:
    """Runs of targets side by side, until the time is over."""

    def __init__(self, build, seconds, targets, record, jobs):
        self.out = os.path.join(build, "fuzz")
        self.corpora = os.path.join(build, "corpus")
        self.end = time.monotonic() + seconds
        self.targets, self.record, self.jobs = targets, record, jobs
        self.running = {}  # target: process, its log, when it began
        self.crashed = []
        self.turns = dict.fromkeys(targets, 0)

    def next(self):
        """The target that has had the fewest turns and, among these, has run least
        in all; it does not run now."""
        free = [target for target in self.targets if target not in self.running]
        return min(free, default=None, key=lambda target: (
            self.turns[target], self.record.rows[target][0]))

    def begin(self, target, seconds):
        found = os.path.join(self.out, f"found-{target}")
        corpus = os.path.join(self.corpora, target)
        for folder in (found, corpus):
            os.makedirs(folder, exist_ok=True)
        log = open(os.path.join(self.out, f"{target}.log"), "wb")
        process = subprocess.Popen(
            [os.path.join(self.out, target), f"-max_total_time={seconds}", *LIMITS,
             f"-artifact_prefix={self.out}/{target}-", found, corpus],
            stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        log.close()
        self.running[target] = process, time.monotonic()
        self.turns[target] += 1

    def finish(self, target):
        """Adds a run that has ended to the record, and says how it went. A crash is
        told by the exit status: when assimp's child process dies, libFuzzer writes
        a mesh-crash-… file although the program has not crashed."""
        process, begun = self.running.pop(target)
        log = os.path.join(self.out, f"{target}.log")
        with open(log, encoding="utf-8", errors="replace") as file:
            text = file.read()
        runs = re.search(r"^stat::number_of_executed_units: *(\d+)", text, re.M)
        crashed = process.returncode not in (0, -signal.SIGINT, INTERRUPTED)
        self.record.add(target, round(time.monotonic() - begun),
                        int(runs[1]) if runs else 0, int(crashed))
        seconds, executions, crashes = self.record.rows[target]
        print(f"{target}: {seconds / 3600:.2f} h so far, {executions} executions, "
              f"{crashes} crashes; {max(self.end - time.monotonic(), 0) / 60:.0f} "
              "min left", flush=True)
        if crashed:
            self.crashed.append(target)
            print(f"FAILED {target}: exit status {process.returncode}, see {log}")
            print("".join(f"    {line}\n" for line in text.splitlines()[-20:]),
                  end="", flush=True)

    def run(self):
        """Returns the targets that crashed."""
        while self.running or self.end - time.monotonic() >= 1:
            left = self.end - time.monotonic()
            while len(self.running) < self.jobs and left >= 1:
                target = self.next()
                if target is None:
                    break
                self.begin(target, max(1, round(min(SLICE, left))))
            time.sleep(0.1)
            for target in list(self.running):
                if self.running[target][0].poll() is not None:
                    self.finish(target)
        return self.crashed

    def stop(self):
        """Ends what runs, and records it."""
        for process, _ in self.running.values():
            process.send_signal(signal.SIGINT)
        for process, _ in self.running.values():
            process.wait()
        for target in list(self.running):
            self.finish(target)


INTERRUPTED = 72  # how libFuzzer ends at Ctrl-C


def main(build, seconds, path, *chosen):
    targets = subprocess.run([os.path.join(build, "replay"), "--list"], check=True,
                             text=True, stdout=subprocess.PIPE).stdout.split()
    turn = chosen == ("--turn",)
    unknown = [] if turn else [name for name in chosen if name not in targets]
    if unknown:
        sys.exit(f"no target {unknown[0]}; there are: {' '.join(targets)}")
    record, jobs = Record(path, targets), os.cpu_count() or 1
    if turn:
        chosen = of_this_turn(targets, max(1, jobs * int(seconds) // SLICE))
        print("in turn:", *chosen)
    soak = Soak(build, float(seconds), list(chosen or targets), record, jobs)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        soak.run()
    except KeyboardInterrupt:
        soak.stop()
    rows = [record.rows[target] for target in soak.targets]
    print(f"{path}: {sum(row[0] for row in rows) / 3600:.1f} hours of "
          f"{len(rows)} targets, the least {min(row[0] for row in rows) / 3600:.2f}")
    bad = len(set(soak.crashed))
    print(f"{len(rows) - bad} passed, {bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
