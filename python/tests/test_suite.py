# SPDX-License-Identifier: Apache-2.0
"""What is missing skips a test by name; what fails is told by name, and all other
tests run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SUITE = Path(__file__).with_name("suite.py")
FILES = {
    "lacking.py": 'raise ImportError("libSM.so.6: cannot open shared object file")',
    "broken.py": "import a_module_of_its_own_that_is_not_here",
    "test_a_library.py": 'from needs import need\nneed("lacking")\n',
    "test_a_module.py": 'from needs import need\n\ndef test_it():\n    need("moto_")\n',
    "test_broken.py": 'from needs import need\nneed("broken")\n',
    "test_error.py": "1 / 0\n",
    "test_ends.py": "def test_good(): pass\ndef test_bad(): assert 1 == 2\n",
    "test_fixture.py": "import pytest\n\n@pytest.fixture\ndef bad():\n"
    "    raise ValueError('a fixture')\n\ndef test_it(bad):\n    pass\n",
}


def run(folder: Path, *names: str) -> tuple[int, str]:
    for name, text in FILES.items():
        (folder / name).write_text(text)
    (folder / "needs.py").write_text(SUITE.with_name("needs.py").read_text())
    command = [sys.executable, SUITE, "--rootdir", folder, *(names or [folder])]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout


def test_each_is_told_by_name(tmp_path: Path) -> None:
    status, said = run(tmp_path)
    lines = said.splitlines()
    assert status == 1 and lines[-1] == "1 passed, 4 failed, 2 skipped"
    for name in ("test_broken.py", "test_error.py", "test_ends.py::test_bad"):
        assert f"FAILED {name}" in lines
    assert "FAILED test_fixture.py::test_it, setup" in lines
    assert "    E   ZeroDivisionError: division by zero" in lines
    assert "    E   assert 1 == 2" in lines
    skipped = [line for line in lines if line.startswith("skipped")]
    assert skipped[0].startswith("skipped: test_a_library.py: lacking cannot be")
    assert "libSM.so.6" in skipped[0] and "sh ci/deps.sh apps" in skipped[0]
    assert skipped[1].startswith("skipped: test_a_module.py::test_it: the module")
    assert "pip install -r python/tests/requirements.txt" in skipped[1]


def test_nothing_run_is_a_failure(tmp_path: Path) -> None:
    status, said = run(tmp_path, "test_nowhere.py")
    assert status == 1 and "0 passed, 1 failed, 0 skipped" in said
