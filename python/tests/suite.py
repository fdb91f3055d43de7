# SPDX-License-Identifier: Apache-2.0
"""Runs tests by pytest for the scripts of ci/, which read its lines: each test that
fails with its last lines, each that is skipped with its reason, and the counts. A
file that cannot be collected is a failure of its own: all others run.

usage: suite.py TEST... [OPTION OF PYTEST...]
Ends with `N passed, N failed, N skipped`.
"""

from __future__ import annotations

import sys

import pytest

LINES = 20  # of a failure


class Lines:
    """Prints a line for what did not pass, and counts."""

    def __init__(self) -> None:
        self.passed = self.failed = self.skipped = 0

    def _fails(self, name: str, text: str) -> None:
        self.failed += 1
        last = text.rstrip().splitlines()[-LINES:]
        print("\n".join([f"FAILED {name}", *(f"    {line}" for line in last)]))

    def _skips(self, report: pytest.TestReport | pytest.CollectReport) -> None:
        self.skipped += 1
        why = report.longrepr[2] if isinstance(report.longrepr, tuple) else ""
        print(f"skipped: {report.nodeid}: {why.removeprefix('Skipped: ')}")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Takes note of a file that was not collected."""
        if report.failed:
            self._fails(report.nodeid, report.longreprtext)
        elif report.skipped:
            self._skips(report)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Takes note of a test, of what it set up, and of what it took down."""
        if report.failed:
            said = "".join(f"\n{name}\n{text}" for name, text in report.sections)
            name = report.nodeid + ("" if report.when == "call" else f", {report.when}")
            self._fails(name, said + "\n" + report.longreprtext)
        elif report.skipped:
            self._skips(report)
        elif report.when == "call":
            self.passed += 1
        sys.stdout.flush()


def main(arguments: list[str]) -> int:
    """Runs the tests, and returns 0 if some passed and none failed."""
    lines = Lines()
    options = ["-p", "no:terminal", "-p", "no:cacheprovider"]
    options += ["--continue-on-collection-errors"]
    status = pytest.main([*options, *arguments], plugins=[lines])
    if not lines.failed and (status != 0 or not lines.passed + lines.skipped):
        print(f"FAILED pytest {' '.join(arguments)}: it ended with {status!r}")
        lines.failed = 1
    print(f"{lines.passed} passed, {lines.failed} failed, {lines.skipped} skipped")
    return 1 if lines.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
