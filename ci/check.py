#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`make check`: runs the parts of ci/part.sh side by side, says which run and
how long the rest will take, and repeats at its end whatever failed.

usage: ci/check.py BUILD [PART...]    without a PART: all of them

The part `build` makes what the others share and runs first, alone. They run one
more at a time than there are processors, as some of them wait: for browsers, for
other processes. BUILD/check.times keeps how long each part took, for the next
run's estimate; before there is such a file, the table below gives it.
"""
import json
import os
import re
import subprocess
import sys
import time

# What each part is, and its seconds on two processors beside two others. The
# longest parts start first.
PARTS = {
    "build": ("what the parts share: library, tool, tests, oracles", 90),
    "tests-32": ("each stage's properties and oracles, the API, in binary32", 800),
    "python": ("the Python package, its pages and its site", 800),
    "asan": ("scenes and stages under AddressSanitizer and UBSan", 560),
    "tests-64": ("the same in binary64", 500),
    "clang-O0": ("the same bits by clang -O0, kernels too", 260),
    "gcc-O0": ("the same bits by gcc -O0, kernels too", 230),
    "tsan": ("whole scenes under ThreadSanitizer", 100),
    "msan": ("whole scenes under MemorySanitizer", 80),
    "ptx": ("PTX of all kernels has the number model's operations only", 360),
    "tidy": ("clang-tidy", 80),
    "tool": ("what the tool answers to good and bad input", 250),
    "clang-O2": ("the same bits by clang -O2", 90),
    "clang-O3": ("the same bits by clang -O3", 70),
    "gcc-O3": ("the same bits by gcc -O3", 80),
    "equal": ("device code and its twins in ref/, for every input", 110),
    "faults": ("planted faults, which the proofs find", 40),
    "buddha": ("the paper's buddha: no intersection in any frame", 60),
    "demo": ("the demo's scene: no intersection in any frame", 50),
    "models": ("kernels in which threads work together, under every schedule", 40),
    "fuzz": ("every input of fuzz/corpus again", 80),
    "device": ("kernels, emulated on the host", 30),
    "validate": ("cloth beside theory, in a short form", 130),
    "counts": ("what contact costs on small scenes, and its bounds", 30),
    "root": ("small scenes: every outcome, and any number of threads", 20),
    "rows": ("a certificate's faults are found", 50),
    "embed": ("the installed library in programs of C, C++ and CMake", 20),
    "maps": ("README's pipeline, the table of stages and the files", 30),
    "accuracy": ("time against error, in a short form", 20),
    "single": ("solves, times of impact and distances by themselves", 1),
    "contracts": ("what proofs take as given of callers, asserted in tests", 20),
    "prove": ("Gappa's proofs of the filters' constants", 20),
    "golden-1": ("recorded hashes of all stages", 10),
    "golden-3": ("recorded hashes of all stages, three threads", 5),
    "format": ("clang-format", 10),
    "harness": ("what make check and a soak tell", 10),
    "certificate": ("the certificate is of this tree", 3),
    "self": ("planted faults, which the tests must find", 2),
    "tokens": ("what the certificate's digests leave out", 1),
}
COUNTS = re.compile(r"(\d+) passed, (\d+) failed(?:, (\d+) skipped)?")
QUIET = 30  # s without a line, after which one says what runs


def clock(seconds):
    """Minutes and seconds, as 3:07."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


class Check:
    """One run of `make check`."""

    def __init__(self, build, parts):
        self.build, self.cores = build, os.cpu_count() or 1
        if hasattr(os, "sched_getaffinity"):
            self.cores = len(os.sched_getaffinity(0))
        self.began = self.spoke = time.monotonic()
        self.waiting, self.running, self.reports = list(parts), {}, {}
        self.seconds = {part: PARTS[part][1] for part in parts}
        self.file = os.path.join(build, "check.times")
        os.makedirs(build, exist_ok=True)
        try:
            with open(self.file, encoding="utf-8") as file:
                self.times = json.load(file)
        except (OSError, ValueError):
            self.times = {}
        self.seconds.update((part, self.times[part]) for part in parts
                            if part in self.times)

    def say(self, text):
        print(text, flush=True)
        self.spoke = time.monotonic()

    def pace(self):
        """How many times as long parts take as they did before: those that have
        ended, and those that should have."""
        now = time.monotonic()
        took = {part: self.times[part] for part in self.reports}
        took.update((part, now - begun) for part, (_, begun) in self.running.items()
                    if now - begun > self.seconds[part])
        before = sum(self.seconds[part] for part in took)
        return sum(took.values()) / before if before else 1

    def left(self):
        """Seconds until the end, at this pace: the work that is left over the parts
        that run at once, or the longest part."""
        now = time.monotonic()
        rest = {part: max(self.seconds[part] - (now - begun), 0)
                for part, (_, begun) in self.running.items()}
        rest.update((part, self.seconds[part]) for part in self.waiting)
        alone = rest.pop("build", 0)
        most = max(rest.values(), default=0)
        slots = self.cores + 1
        return self.pace() * (alone + max(sum(rest.values()) / slots, most))

    def announce(self):
        """The list of parts."""
        self.say(f"{len(self.waiting)} parts, {self.cores + 1} at a time, "
                 f"about {clock(self.left())}:")
        for part in self.waiting:
            self.say(f"  {part:12} {clock(self.seconds[part]):>5}  "
                     f"{PARTS[part][0]}")

    def begin(self, part):
        """Starts a part; what it prints goes to a file."""
        jobs = self.cores if part == "build" else 1
        with open(self.output(part), "wb") as file:
            process = subprocess.Popen(
                ["sh", "ci/part.sh", self.build, part, str(jobs)], stdout=file,
                stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        self.running[part] = process, time.monotonic()

    def output(self, part):
        return os.path.join(self.build, f"check-{part}.out")

    def end(self, part):
        """Shows what a part that has ended has printed, and notes its time."""
        process, begun = self.running.pop(part)
        with open(self.output(part), encoding="utf-8", errors="replace") as file:
            text = file.read().rstrip()
        os.remove(self.output(part))
        if not COUNTS.search(text.split("\n", 1)[0]):
            text = (f"{part}: 0 passed, 1 failed\nFAILED {part}: it ended with "
                    f"status {process.returncode} and no counts\n{text}")
        self.reports[part] = text
        self.say(text)
        self.times[part] = round(time.monotonic() - begun)
        with open(self.file, "w", encoding="utf-8") as file:
            json.dump(self.times, file, indent=0)

    def beat(self):
        """Says what runs, if nothing was said for a while."""
        now = time.monotonic()
        if now - self.spoke < QUIET:
            return
        what = ", ".join(f"{part} ({clock(now - begun)} of "
                         f"{clock(self.seconds[part])})"
                         for part, (_, begun) in self.running.items())
        self.say(f"[{clock(now - self.began)}] {len(self.reports)} parts done; "
                 f"now {what}; {len(self.waiting)} to come; about "
                 f"{clock(self.left())} left")

    def failed(self, part):
        return int(COUNTS.search(self.reports[part])[2])

    def run(self):
        """Runs all parts. If the build fails, there is nothing to run."""
        self.announce()
        while self.waiting or self.running:
            alone = "build" in self.running
            while self.waiting and len(self.running) <= self.cores and not alone:
                part = self.waiting.pop(0)
                self.begin(part)
                alone = part == "build"
            time.sleep(0.1)
            for part in list(self.running):
                if self.running[part][0].poll() is not None:
                    self.end(part)
                    if part == "build" and self.failed(part):
                        self.waiting = []
            self.beat()
        return self.summary()

    def summary(self):
        """Repeats what was skipped and what failed; the last line counts."""
        counts = [0, 0, 0]
        for text in self.reports.values():
            for k, count in enumerate(COUNTS.search(text).groups()):
                counts[k] += int(count or 0)
        for part, text in self.reports.items():
            for line in text.split("\n")[1:]:
                if line.startswith("skipped"):
                    self.say(f"{part}: {line}")
        if os.path.exists("ci/certificate.json"):
            done = subprocess.run([sys.executable, "ci/certificate.py", "line",
                                   "ci/certificate.json"], check=False, text=True,
                                  stdout=subprocess.PIPE)
            self.say(f"certificate: {done.stdout.strip()}")
        bad = [part for part in self.reports if self.failed(part)]
        for part in bad:
            self.say(f"\nfailed: {part} (sh ci/part.sh {self.build} {part})\n"
                     f"{self.reports[part]}")
        line = "{} passed, {} failed, {} skipped".format(*counts)
        self.say(f"{line} in {clock(time.monotonic() - self.began)}"
                 + (f"; failed: {', '.join(bad)}" if bad else ""))
        return 1 if bad or not counts[0] else 0

    def stop(self):
        """Ends what runs, at Ctrl-C, which the parts hear themselves."""
        for process, _ in self.running.values():
            process.terminate()
        for part, (process, _) in self.running.items():
            process.wait()
            os.remove(self.output(part))


def main(build=None, *parts):
    if not build or set(parts) - set(PARTS):
        sys.exit(__doc__ + "\nparts: " + " ".join(PARTS))
    check = Check(build, parts or PARTS)
    try:
        return check.run()
    except KeyboardInterrupt:
        check.stop()
        sys.exit("make check: stopped")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
