# SPDX-License-Identifier: Apache-2.0
"""Worlds: their arrays, what they report, and what they refuse."""

from __future__ import annotations

import copy
import gc
import pickle
import warnings
import weakref
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

import drape


def test_arrays_follow_the_world(tiny: Path) -> None:
    world = drape.World(tiny)
    x, v = world.positions, world.velocities
    part = x[world.bodies[0].vertices]
    before = part.copy()
    for _ in range(5):
        world.step()
        exact = world.read()
        assert np.array_equal(x, exact[0]) and np.array_equal(v, exact[1])
        assert np.array_equal(part, exact[0][: len(part)])
    assert not np.array_equal(part, before)
    assert x.dtype == np.float32 and x.shape == (len(world), 3)


def test_arrays_cannot_be_written(tiny: Path) -> None:
    world = drape.World(tiny)
    for array in (world.positions, world.triangles, np.asarray(world.share()[0])):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


def test_bodies_are_slices_of_the_arrays(tiny: Path) -> None:
    world = drape.World(tiny)
    cloth, ball = world.bodies
    assert (cloth.kind, ball.kind) == ("cloth", "obstacle")
    m, n = cloth.particles or (0, 0)
    assert cloth.vertices == slice(0, m * n)
    assert ball.vertices == slice(m * n, len(world))
    assert ball.triangles.stop == len(world.triangles)
    assert world.triangles[ball.triangles].min() == m * n
    assert world.body(ball.name) is ball
    with pytest.raises(KeyError, match="nothing"):
        world.body("nothing")


def test_reports(tiny: Path) -> None:
    world = drape.World(tiny)
    assert world.report is None
    reports = world.step(6)
    assert [report.step for report in reports] == [1, 2, 3, 4, 5, 6]
    assert reports[-1].time == pytest.approx(6 * world.dt)
    assert reports.clean and reports.outcome == 0
    assert world.report is reports[-1]
    assert set(reports[0].seconds) == {
        *("integration", "solver", "broad", "proximity", "penetration")
    }
    assert reports[-1].work.tries >= reports[-1].slices


def test_a_start_that_intersects(sheet: dict[str, Any]) -> None:
    sheet["cloths"].append(
        {"particles": [5, 5], "size": [0.3, 0.3], "start": {"v": [0, 1, 0]}}
    )
    with pytest.raises(drape.SceneError, match="intersect"):
        drape.World(sheet)
    world = drape.World(sheet, allow_intersecting=True)
    found = world.audit()
    assert found.count > 0 and found.pairs.shape == (found.count, 2)
    reports = world.step()
    assert reports.outcome & drape.Outcome.TRAPPED and not reports.clean


def test_a_number_of_steps_is_not_negative(sheet: dict[str, Any]) -> None:
    world = drape.World(sheet)
    with pytest.raises(ValueError, match="-1"):
        world.step(-1)
    assert world.step(0) == [] and world.report is None


def test_sleep_and_wake(sheet: dict[str, Any]) -> None:
    world = drape.World(sheet, gravity=[0, 0, 0])
    assert world.step(40).outcome & drape.Outcome.ASLEEP
    world.wake()
    assert not world.step()[0].outcome & drape.Outcome.ASLEEP


def test_wind(sheet: dict[str, Any]) -> None:
    sheet["wind"] = {"velocity": [0, 0, 0]}
    sheet["gravity"] = [0, 0, 0]
    world = drape.World(sheet)
    world.set_wind(drape.Wind(velocity=[0, 5, 0]))
    world.step(3)
    assert world.positions[:, 1].min() > 0
    still = drape.World({**sheet, "wind": {"density": 0}})
    still.set_wind({"velocity": [0, 5, 0]})  # made without air
    still.step(3)
    assert (still.positions == world.positions).all()
    still.set_wind({"density": 0})
    with pytest.warns(UserWarning, match="velocity: note: has no effect"):
        world.set_wind({"velocity": [0, 5, 0], "density": 0})
    with pytest.warns(UserWarning, match="velocity: note: has no effect"):
        world.set_wind({"velocity": [0, 5, 0], "drag": 0, "lift": 0})
    with pytest.raises(drape.SceneError, match='"speed"; did you mean "velocity"'):
        world.set_wind({"speed": 1})
    with pytest.raises(drape.SceneError, match=r"wind\.density: expected numbers"):
        world.set_wind({"density": "thin"})
    with pytest.raises(drape.SceneError, match=r"wind: expected keys, .* not \[5, 0"):
        world.set_wind([5, 0, 0])  # type: ignore[arg-type]
    with pytest.raises(drape.SceneError, match="3 numbers"):
        world.set_wind({"velocity": [1, 2]})
    with pytest.raises(drape.SceneError, match=r"wind\.density: -1: expected .* 0 to"):
        world.set_wind({"density": -1})


def test_a_cloth_that_no_fabric_bears_is_told(sheet: dict[str, Any]) -> None:
    m, n = sheet["cloths"][0]["particles"]
    sheet["cloths"][0] |= {"name": "b", "material": {"stretch": 1, "shear": 0.3}}
    sheet["cloths"][0]["pins"] = [{"edge": "u0"}]
    world = drape.World(sheet, gravity=[50, 0, 0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step(1)
    with pytest.warns(UserWarning, match=r"^b: note: after step 60 it is stretched to"):
        world.step(59)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # it is told once
        world.step(60)
    width = sheet["cloths"][0].get("size", [1, 1])[0] / (m - 1)
    x = world.positions[: m * n].reshape(n, m, 3)
    assert np.linalg.norm(np.diff(x, axis=1), axis=2).max() > 2 * width


def test_plan_and_memory(tiny: Path) -> None:
    world = drape.World(tiny)
    rows = {row.stage: row for row in world.plan()}
    assert rows["narrow"].on and not rows["wind"].on and rows["wind"].why
    assert world.memory().host_bytes > 1000
    assert world.memory().device_bytes == 0


def test_log_and_trace_may_fail(tiny: Path) -> None:
    lines: list[str] = []
    drape.World(tiny, log=lines.append)
    assert lines

    def wrong(*_: object) -> None:
        raise RuntimeError("of the caller's")

    world = drape.World(tiny, trace=wrong)
    with pytest.raises(RuntimeError, match="of the caller's"):
        world.step()

    def inward(*_: object) -> None:
        worlds[0].read()

    worlds = [drape.World(tiny, trace=inward)]
    with pytest.raises(drape.Error, match="own world"):
        worlds[0].step()


def test_shared_arrays_keep_the_world(tiny: Path) -> None:
    world = drape.World(tiny)
    world.step(2)
    exact = world.read()[0]
    array = np.asarray(world.share()[0])
    handle = weakref.ref(world._handle)
    world.close()
    gc.collect()
    assert handle() is not None and np.array_equal(array, exact)
    with pytest.raises(drape.Error, match="closed"):
        world.step()
    del array
    gc.collect()
    assert handle() is None


def test_pictures(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    path = world.render(tmp_path / "a.png", width=64, height=48, samples=2)
    head = path.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    assert head[16:24] == (64).to_bytes(4, "big") + (48).to_bytes(4, "big")
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(drape.Error, match=r"b\.jpg: expected .* \.png"):
        world.render(tmp_path / "b.jpg")
    with pytest.raises(drape.Error, match=r"there is no folder .*nowhere"):
        world.render(tmp_path / "nowhere/b.png")


def test_memory_limit(sheet: dict[str, Any]) -> None:
    sheet["cloths"][0]["particles"] = [101, 101]
    sheet["cloths"][0]["size"] = [1, 1]
    with pytest.raises(drape.OutOfMemoryError, match="memory") as raised:
        drape.World(sheet, memory=0.006)
    assert raised.value.status == drape.Status.ENOMEM


def test_no_device_here(tiny: Path) -> None:
    if "gpu: not built in" not in drape.info():
        pytest.skip("this build has the device's part")
    with pytest.raises(drape.DeviceError, match="backend"):
        drape.World(tiny, backend="gpu")


def test_what_is_printed_is_short(tiny: Path, tmp_path: Path) -> None:
    world = drape.World(tiny)
    assert repr(world.step(3)) == "<drape.Reports: 3 steps, clean>"
    assert repr(world).endswith(" 3 steps, 0.05 s>")
    shared = world.share()[0]
    assert repr(shared) == "<drape.SharedArray: (143, 3) float32 on the host>"
    assert len(shared) == len(world)
    done = drape.sweep([tiny, {"cloths": []}], tmp_path, frames=1)
    assert repr(done).startswith("<drape.Sweep: 2 scenes, 1 failed, 0 reused, ")
    assert repr(world.audit()) == "<drape.Audit: 0 intersecting pairs>"
    assert repr(world.contacts()).endswith(" pairs in 0.01667 s>")
    cloth = drape.Cloth(particles=[2, 2], positions=np.zeros((4, 3)))
    text = "drape.Cloth(particles=[2, 2], positions=<4 × 3 float64>)"
    assert repr(cloth) == text
    assert repr(drape.Scene(cloths=[cloth], dt=0.01)) == (
        f"drape.Scene(cloths=[{text}], dt=0.01)"
    )
    points = [[k, 0.1] for k in range(100)]
    assert len(repr(drape.Material(stretch={"warp": points}))) < 120


def test_reports_are_columns_too(tiny: Path) -> None:
    reports = drape.World(tiny).step(4)
    assert reports["step"].tolist() == [1, 2, 3, 4]
    assert reports["kinetic"].tolist() == [each.kinetic for each in reports]
    assert reports["seconds.solver"].shape == reports["work.near"].shape == (4,)
    assert isinstance(reports[1:], drape.Reports) and len(reports[1:]) == 3
    assert reports[-1].step == 4
    with pytest.raises(KeyError, match="kinetics: expected one of step, time"):
        reports["kinetics"]
    frame = need("pandas") and reports.to_pandas()
    assert (
        frame.shape == (4, len(reports.columns()))
        and frame["time"].is_monotonic_increasing
    )
    assert len(drape.Reports().columns()["step"]) == 0


def test_a_notebook_shows_a_picture(
    tiny: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = drape.World(tiny)
    shown = world._repr_html_()
    assert "&lt;drape.World &#x27;tiny&#x27;" in shown
    assert 'src="data:image/png;base64,iVBOR' in shown
    monkeypatch.setenv("DRAPE_TOOL", "/nowhere")
    assert "<img" not in world._repr_html_()
    world.close()
    assert world._repr_html_() == "<code>&lt;drape.World: closed&gt;</code>"


def test_a_start_that_intersects_is_printed(sheet: dict[str, Any]) -> None:
    sheet["cloths"].append(
        {"particles": [5, 5], "size": [0.3, 0.3], "start": {"v": [0, 1, 0]}}
    )
    reports = drape.World(sheet, allow_intersecting=True).step()
    assert "1 steps, not clean: " in repr(reports) and "TRAPPED" in repr(reports)


def test_a_world_is_not_copied(tiny: Path) -> None:
    world = drape.World(tiny)
    for call in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="checkpoint"):
            call(world)


def test_a_folder_that_holds_a_run(tiny: Path, tmp_path: Path) -> None:
    drape.World(tiny).record(tmp_path).close()
    with pytest.raises(drape.SceneError, match=r"another folder, or force=True"):
        drape.World(tiny).record(tmp_path)
    drape.World(tiny).record(tmp_path, force=True).close()
