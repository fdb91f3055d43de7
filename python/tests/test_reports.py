# SPDX-License-Identifier: Apache-2.0
"""The reports are those of spec/drape.h."""

from __future__ import annotations

import dataclasses
import importlib.util
import re
from typing import Any

import pytest
from conftest import ROOT

import drape
from drape import reports
from drape._core import ffi, lib

STRUCTS = {
    "drape_work": reports.Work,
    "drape_step_report": reports.StepReport,
    "drape_plan_row": reports.PlanRow,
    "drape_memory": reports.Memory,
}


def generator() -> Any:
    spec = importlib.util.spec_from_file_location(
        "generate", ROOT / "python/generate.py"
    )
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_file_is_what_the_header_says() -> None:
    text = (ROOT / "python/drape/reports.py").read_text(encoding="utf-8")
    assert text == generator().written()


@pytest.mark.parametrize("name", STRUCTS)
def test_fields_are_those_of_the_struct(name: str) -> None:
    theirs = [field for field, _ in ffi.typeof(name).fields]
    assert theirs == [field.name for field in dataclasses.fields(STRUCTS[name])]


def test_enumerations_are_those_of_the_header() -> None:
    for kind in (reports.Status, reports.Outcome):
        for member in kind:
            assert getattr(lib, f"DRAPE_{member.name}") == member.value
    assert len(reports.PARTS) == lib.DRAPE_PART_COUNT
    for status in reports.Status:
        assert "unknown" not in ffi.string(lib.drape_status_text(status)).decode()


def test_every_function_of_the_header_is_there() -> None:
    text = (ROOT / "spec/drape.h").read_text(encoding="utf-8")
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    names = set(re.findall(r"\b(drape_\w+)\((?=[^)]*\)?[^;]*;)", text))
    names -= set(re.findall(r"typedef \w+ (drape_\w+)\(", text))
    assert len(names) > 20
    missing = {name for name in names if not hasattr(lib, name)}
    assert not missing


def report(step: int, outcome: reports.Outcome) -> reports.StepReport:
    """A report of a step in which nothing but its outcome is not 0."""
    zeros = {field.name: 0 for field in dataclasses.fields(reports.StepReport)}
    return reports.StepReport(**{**zeros, "step": step, "outcome": outcome})


# drape.h: after a step without TRAPPED nothing intersects, and PASSED and DIVERGED
# tell of the way there. The other outcomes are no fault.
FAULTS = {"TRAPPED", "PASSED", "DIVERGED"}


@pytest.mark.parametrize("name", [each.name for each in reports.Outcome])
def test_what_is_clean(name: str) -> None:
    one = reports.Outcome[name]
    everything = reports.Outcome(sum(reports.Outcome))
    for at in range(3):  # whichever step it happened in
        steps = [reports.Outcome(0)] * 3
        steps[at] = one
        made = drape.Reports(report(k + 1, each) for k, each in enumerate(steps))
        assert made.clean is (name not in FAULTS)
        assert made.outcome == one and name in repr(made)
        steps[at] = everything & ~one
        made = drape.Reports(report(k + 1, each) for k, each in enumerate(steps))
        assert not made.clean
        said = set(repr(made).rstrip(">").split(": ")[-1].split("|"))
        assert said == {each.name for each in reports.Outcome if each is not one}
    assert drape.Reports().clean and drape.Reports().outcome == 0


def test_versions() -> None:
    text = (ROOT / "spec/drape.h").read_text(encoding="utf-8")
    found = re.search(r'DRAPE_VERSION "(.*)"', text)
    assert found and drape.__version__.split("+")[0] == found[1]
    assert f"drape {found[1]}" in drape.info()
