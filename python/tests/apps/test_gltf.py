# SPDX-License-Identifier: Apache-2.0
"""A run written as glTF: what its accessors hold, and what a viewer adds up."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need

from drape.export import Run, RunError
from drape.export.cli import export

need("pygltflib")
from drape.export import gltf  # noqa: E402


class Glb:
    """A .glb, read by the rules of its specification and nothing of ours."""

    def __init__(self, file: Path) -> None:
        data = file.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        self.root: dict[str, Any] = json.loads(data[20 : 20 + size])
        bytes_, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert kind == b"BIN\0" and 28 + size + bytes_ == len(data)
        self.data = data[28 + size :]

    def array(self, accessor: int) -> np.ndarray:
        """The numbers of an accessor, [count, components]."""
        a = self.root["accessors"][accessor]
        view = self.root["bufferViews"][a["bufferView"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[a["type"]]
        kind = {5126: "<f4", 5125: "<u4"}[a["componentType"]]
        assert view["byteOffset"] % 4 == 0
        assert view["byteLength"] == a["count"] * width * 4
        array = np.frombuffer(
            self.data, kind, a["count"] * width, view["byteOffset"]
        ).reshape(-1, width)
        if a.get("max"):
            assert np.array_equal(array.max(0), np.array(a["max"], np.float32))
            assert np.array_equal(array.min(0), np.array(a["min"], np.float32))
        return array


def read(folder: Path, file: Path) -> tuple[Run, Glb]:
    """Exports a run and reads it back."""
    run = Run(folder)
    export(run, file)
    return run, Glb(file)


def test_the_first_frame_has_all_bits(still: Path, tmp_path: Path) -> None:
    run, glb = read(still, tmp_path / "run.glb")
    assert [n["name"] for n in glb.root["nodes"]] == [b.name for b in run.bodies]
    for node, body in zip(glb.root["nodes"], run.bodies, strict=True):
        part = glb.root["meshes"][node["mesh"]]["primitives"][0]
        x = glb.array(part["attributes"]["POSITION"])
        faces = glb.array(part["indices"]).reshape(-1, 3)
        assert np.array_equal(x[faces], run.positions(body, 0)[body.faces])
        if body.uv is not None:
            uv = glb.array(part["attributes"]["TEXCOORD_0"])
            assert np.allclose(uv, [0, 1] + body.uv * [1, -1], atol=1e-7)


@pytest.mark.parametrize("name", ["still", "pushed", "wide"])
def test_a_later_frame_is_exact_to_its_last_place(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    run, glb = read(request.getfixturevalue(name), tmp_path / "run.glb")
    frames = run.frames()
    for node, body in zip(glb.root["nodes"], run.bodies, strict=True):
        part = glb.root["meshes"][node["mesh"]]["primitives"][0]
        x = glb.array(part["attributes"]["POSITION"])
        normal = glb.array(part["attributes"]["NORMAL"])
        faces = glb.array(part["indices"]).reshape(-1, 3)
        targets = part.get("targets") or []
        assert len(targets) == (len(frames) - 1 if body.moving else 0)
        for frame, target in zip(frames[1:], targets, strict=False):
            got = (x + glb.array(target["POSITION"]))[faces]
            expected = run.positions(body, frame)[body.faces].astype(np.float32)
            larger = np.maximum(np.abs(expected), np.abs(x[faces]))
            assert (np.abs(got - expected) <= np.spacing(larger)).all()
            length = np.linalg.norm(normal + glb.array(target["NORMAL"]), axis=1)
            assert np.allclose(length, 1, atol=1e-6)


def test_at_each_time_one_target_is_shown(pushed: Path, tmp_path: Path) -> None:
    run, glb = read(pushed, tmp_path / "run.glb")
    [animation] = glb.root["animations"]
    [sampler] = animation["samplers"]
    times = glb.array(sampler["input"]).ravel()
    assert np.array_equal(times, np.array([0, 2, 4, 6, 8], np.float32) / 24)
    weights = glb.array(sampler["output"]).reshape(5, 4)
    assert np.array_equal(weights, np.eye(5)[:, 1:])
    nodes = [c["target"]["node"] for c in animation["channels"]]
    assert nodes == [k for k, b in enumerate(run.bodies) if b.moving]
    assert sampler["interpolation"] == "LINEAR"


def test_more_than_a_glb_can_hold_is_refused(
    still: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gltf, "LARGEST", 20000)
    with pytest.raises(RunError, match="take fewer by --every"):
        export(Run(still), tmp_path / "run.glb")
    assert export(Run(still), tmp_path / "run.glb", every=8) == 2


def test_another_reader_sees_the_same(still: Path, tmp_path: Path) -> None:
    trimesh = need("trimesh")
    run, _ = read(still, tmp_path / "run.glb")
    scene = trimesh.load(tmp_path / "run.glb", process=False)
    ball = scene.geometry["ball"]
    assert np.array_equal(
        ball.vertices[ball.faces].astype(np.float32),
        run.positions(run.bodies[2], 0)[run.bodies[2].faces],
    )
