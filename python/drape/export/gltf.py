# SPDX-License-Identifier: Apache-2.0
"""Writes a run as binary glTF: one mesh a body, animated by morph targets.

The first frame is the mesh. Each later frame is a morph target, which is what
its positions and normals differ from the first frame's, and an animation of the
weights shows one target at a time: at a frame's time its weight is 1, between
two frames both are blended. The first frame keeps every bit of a run of 32
bits. A later coordinate is a sum that the viewer rounds, so it is exact to one
unit in the last place of the larger of its first and its own value: USD keeps
every bit. glTF is in metres with +y up, as the run is, and counts v downwards.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as g
from numpy.typing import NDArray

from drape.export import mesh
from drape.export.run import Body, Run, RunError

LARGEST = 2**32 - 1  # bytes of a file, whose length has 32 bits


class _Buffer:
    """The binary chunk, and the accessors into it."""

    def __init__(self, gltf: g.GLTF2) -> None:
        self.gltf, self.chunks, self.length = gltf, list[bytes](), 0

    def add(self, array: NDArray[Any], type_: str, target: int | None = None) -> int:
        """Appends an array of float32 or uint32; returns its accessor."""
        data = np.ascontiguousarray(array).tobytes()
        view = g.BufferView(
            buffer=0, byteOffset=self.length, byteLength=len(data), target=target
        )
        self.gltf.bufferViews.append(view)
        real = array.dtype == np.float32
        rows = array.reshape(len(array), -1)
        accessor = g.Accessor(
            bufferView=len(self.gltf.bufferViews) - 1,
            componentType=g.FLOAT if real else g.UNSIGNED_INT,
            count=len(array),
            type=type_,
            min=rows.min(0).tolist() if real else None,
            max=rows.max(0).tolist() if real else None,
        )
        self.gltf.accessors.append(accessor)
        self.chunks.append(data)
        self.length += len(data)
        return len(self.gltf.accessors) - 1


class _Shape:
    """A body's vertices as glTF wants them, each with one normal.

    So a corner at an edge of an obstacle is a vertex of its own.
    """

    def __init__(self, run: Run, body: Body, frame: int) -> None:
        self.run, self.body = run, body
        cloth = body.kind == "cloth"
        x, faces = run.positions(body, frame), body.faces
        flat = np.arange(3 * len(faces)).reshape(-1, 3)
        self.sharp = (
            np.zeros(faces.shape, bool) if cloth else mesh.sharp_corners(x, faces)
        )
        key = np.where(self.sharp, len(x) + flat, faces).ravel()
        _, self.corner, self.faces = np.unique(
            key, return_index=True, return_inverse=True
        )
        self.rows = faces.ravel()[self.corner]

    def at(self, frame: int) -> tuple[NDArray[Any], NDArray[Any]]:
        """Positions and normals [vertices, 3] of a frame."""
        x, faces = self.run.positions(self.body, frame), self.body.faces
        normal = mesh.corner_normals(x, faces, self.sharp).reshape(-1, 3)
        return x.astype(np.float32)[self.rows], normal[self.corner]


def _check_size(run: Run, frames: list[int]) -> None:
    bytes_ = sum(
        len(b.rows) * 24 * (len(frames) if b.moving else 1) for b in run.bodies
    )
    if bytes_ > LARGEST:
        raise RunError(
            f"{run.folder}: {len(frames)} frames are {bytes_ / 1e9:.1f} GB, and a "
            ".glb has at most 4.3: take fewer by --every, or write .usdc"
        )


def _mesh(buffer: _Buffer, run: Run, body: Body, frames: list[int]) -> g.Mesh:
    shape = _Shape(run, body, frames[0])
    x, normal = shape.at(frames[0])
    array = g.ARRAY_BUFFER
    attributes = g.Attributes(
        POSITION=buffer.add(x, g.VEC3, array), NORMAL=buffer.add(normal, g.VEC3, array)
    )
    if body.uv is not None:
        uv = np.stack([body.uv[:, 0], 1 - body.uv[:, 1]], 1)[shape.rows]
        attributes.TEXCOORD_0 = buffer.add(uv.astype(np.float32), g.VEC2, array)
    faces = shape.faces.astype(np.uint32).ravel()
    primitive = g.Primitive(
        attributes=attributes,
        indices=buffer.add(faces, g.SCALAR, g.ELEMENT_ARRAY_BUFFER),
        targets=[],
    )
    for frame in frames[1:] if body.moving else []:
        y, turned = shape.at(frame)
        primitive.targets.append(
            {
                "POSITION": buffer.add(y - x, g.VEC3, array),
                "NORMAL": buffer.add(turned - normal, g.VEC3, array),
            }
        )
    count = len(primitive.targets)
    return g.Mesh(
        name=body.name,
        primitives=[primitive],
        weights=[0.0] * count,
        extras={"targetNames": [f"frame {k}" for k in frames[1:][:count]]},
    )


def _animate(gltf: g.GLTF2, buffer: _Buffer, run: Run, frames: list[int]) -> None:
    """The weights of every mesh with targets: the one of each time is 1."""
    times = (np.array(frames) - frames[0]) * run.seconds
    clock = buffer.add(times.astype(np.float32), g.SCALAR)
    weights = np.eye(len(frames), dtype=np.float32)[:, 1:].ravel()
    rows = buffer.add(weights, g.SCALAR)
    animation = g.Animation(name=run.scene, channels=[], samplers=[])
    animation.samplers.append(
        g.AnimationSampler(input=clock, output=rows, interpolation="LINEAR")
    )
    for node, body in enumerate(run.bodies):
        if body.moving:
            target = g.AnimationChannelTarget(node=node, path="weights")
            animation.channels.append(g.AnimationChannel(sampler=0, target=target))
    gltf.animations.append(animation)


def _material(name: str, rgb: tuple[float, ...]) -> g.Material:
    surface = g.PbrMetallicRoughness(
        baseColorFactor=[*rgb, 1.0], metallicFactor=0.0, roughnessFactor=0.85
    )
    return g.Material(name=name, pbrMetallicRoughness=surface, doubleSided=True)


def write(run: Run, frames: list[int], path: Path) -> None:
    """Writes these frames of the run into a file."""
    _check_size(run, frames)
    extras: dict[str, Any] = {"drape": run.report["drape"], "fps": run.fps}
    gltf = g.GLTF2(
        asset=g.Asset(version="2.0", generator="drape", extras=extras), scene=0
    )
    buffer = _Buffer(gltf)
    for number, body in enumerate(run.bodies):
        made = _mesh(buffer, run, body, frames)
        made.primitives[0].material = number
        gltf.meshes.append(made)
        gltf.materials.append(_material(body.name, mesh.colour(body, number)))
        gltf.nodes.append(g.Node(name=body.name, mesh=number))
    gltf.scenes.append(g.Scene(nodes=list(range(len(gltf.nodes)))))
    if len(frames) > 1:
        _animate(gltf, buffer, run, frames)
    gltf.buffers.append(g.Buffer(byteLength=buffer.length))
    gltf.set_binary_blob(b"".join(buffer.chunks))
    gltf.save_binary(str(path))


def snapshot(
    x: NDArray[Any], normal: NDArray[Any], faces: NDArray[Any], rgb: NDArray[Any]
) -> bytes:
    """A mesh of one moment as a .glb, with a linear colour for each vertex."""
    gltf = g.GLTF2(asset=g.Asset(version="2.0", generator="drape"), scene=0)
    buffer, array = _Buffer(gltf), g.ARRAY_BUFFER
    attributes = g.Attributes(
        POSITION=buffer.add(x.astype(np.float32), g.VEC3, array),
        NORMAL=buffer.add(normal.astype(np.float32), g.VEC3, array),
        COLOR_0=buffer.add(rgb.astype(np.float32), g.VEC3, array),
    )
    indices = buffer.add(
        faces.astype(np.uint32).ravel(), g.SCALAR, g.ELEMENT_ARRAY_BUFFER
    )
    primitive = g.Primitive(attributes=attributes, indices=indices, material=0)
    gltf.meshes.append(g.Mesh(primitives=[primitive]))
    gltf.materials.append(_material("colours", (1.0, 1.0, 1.0)))
    gltf.nodes.append(g.Node(mesh=0))
    gltf.scenes.append(g.Scene(nodes=[0]))
    gltf.buffers.append(g.Buffer(byteLength=buffer.length))
    gltf.set_binary_blob(b"".join(buffer.chunks))
    return b"".join(gltf.save_to_bytes())
