# SPDX-License-Identifier: Apache-2.0
"""The T-shirt of app/patterns/tee.json as a mesh with UV charts, where it was sewn."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from charted import Charted
from numpy.typing import NDArray

import drape
from drape.export.run import read_ply

Array = NDArray[Any]
PATTERN = drape.examples.PATTERNS / "tee.json"


def points(panel: dict[str, Any], edge: dict[str, Any], n: int) -> Array:
    """[n + 1, 2] points of an edge of a pattern, at equal parts of its length."""
    t = np.linspace(0, 1, 2001)
    a, b = (np.array(panel["vertices"][v], float) for v in edge["endpoints"])
    chord = b - a
    left = np.array([-chord[1], chord[0]])
    bent = edge.get("curvature")
    if bent is None:
        line = a + t[:, None] * chord
    elif bent["type"] == "circle":
        radius, large, turns_left = bent["params"]
        assert not large
        half = np.arcsin(np.linalg.norm(chord) / 2 / radius)
        side = 1 if turns_left else -1
        middle = (a + b) / 2 + side * left / np.linalg.norm(left) * radius * np.cos(
            half
        )
        angle = side * 2 * half * t
        to = a - middle
        turned = np.array([-to[1], to[0]])
        line = middle + np.cos(angle)[:, None] * to + np.sin(angle)[:, None] * turned
    else:
        inner = [a + x * chord + y * left for x, y in bent["params"]]
        line = np.zeros((len(t), 2))
        corner = [a, *inner, b]
        power = len(corner) - 1
        for k, p in enumerate(corner):
            times = [1, 2, 1][k] if power == 2 else [1, 3, 3, 1][k]
            line += (times * t**k * (1 - t) ** (power - k))[:, None] * p
    s = np.append(0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    at = np.linspace(0, s[-1], n + 1)
    found = np.stack([np.interp(at, s, line[:, i]) for i in range(2)], 1)
    found[0], found[-1] = a, b
    return found


def delaunay(x: Array) -> Array:
    """The triangles of points in the plane, by Bowyer and Watson."""
    n = len(x)
    middle, size = x.mean(0), 20 * np.ptp(x)
    big = middle + size * np.array([[-2, -1], [2, -1], [0, 2]])
    p = np.concatenate([x, big])
    tri = np.array([[n, n + 1, n + 2]])
    for k in range(n):
        a, b, c = (p[tri[:, i]] - p[k] for i in range(3))
        square = [(q**2).sum(1) for q in (a, b, c)]
        inside = (
            square[0] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
            - square[1] * (a[:, 0] * c[:, 1] - a[:, 1] * c[:, 0])
            + square[2] * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        ) > 0
        edges = [(t[i], t[(i + 1) % 3]) for t in tri[inside].tolist() for i in range(3)]
        there = set(edges)
        rim = [e for e in edges if e[::-1] not in there]
        new = np.array([[u, v, k] for u, v in rim])
        tri = np.concatenate([tri[~inside], new])
    return tri[(tri < n).all(1)]


def inside(x: Array, ring: Array) -> Array:
    """Whether points are in a polygon."""
    found = np.zeros(len(x), bool)
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        over = (a[1] > x[:, 1]) != (b[1] > x[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (x[:, 1] - a[1]) / (b[1] - a[1])
        found ^= over & (a[0] + t * (b[0] - a[0]) > x[:, 0])
    return found


def filled(ring: Array, h: float) -> tuple[Array, Array]:
    """Points [n, 2], those of a polygon first, and triangles, about h wide."""
    lo, hi = ring.min(0), ring.max(0)
    count = np.floor((hi - lo) / h).astype(int) + 1
    i, j = (each.ravel() for each in np.meshgrid(*map(np.arange, count)))
    grid = lo + h * np.stack([i + j % 2 / 2, j], 1)
    far = np.linalg.norm(grid[:, None] - ring, axis=2).min(1) > 0.6 * h
    x = np.concatenate([ring, grid[inside(grid, ring) & far]])
    # no four on a circle, nor three on a line: those make slivers along the rim
    tri = delaunay(x + 1e-4 * h * np.random.default_rng(0).random(x.shape))
    a, b = (x[tri[:, k]] - x[tri[:, 0]] for k in (1, 2))
    wide = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 1e-2 * h**2
    return x, tri[wide & inside(x[tri].mean(1), ring)]


def body(thinner: float = 0) -> list[drape.Obstacle]:
    """Who wears it: capsules, thinner by so much, m."""
    arm = {"shape": "capsule", "radius": 0.042 - thinner, "length": 0.5}
    arm["axis"] = [0, 0, 1]
    trunk = {"shape": "capsule", "at": [0, 1.12, 0]}
    return [
        drape.Obstacle(**trunk, radius=0.125 - thinner, length=0.6),
        drape.Obstacle(**arm, angle=50, at=[0.31, 1.345, 0]),
        drape.Obstacle(**arm, angle=-50, at=[-0.31, 1.345, 0]),
    ]


def tee(folder: Path, cell: float = 0.04, h: float = 0.03) -> Charted:
    """Returns the T-shirt when its seams have been closed on `body`, by triangles about
    h wide; what is sewn together shares its vertices."""
    sewn = drape.sew(PATTERN, body(), cell=cell, frames=56, pictures=False)
    drape.tool.call("pattern", PATTERN, "--cell", cell, "--out", folder)
    flat = [read_ply(file) for file in sorted(folder.glob("0*.ply"))]
    pattern = json.loads(PATTERN.read_text())["pattern"]
    panels = {name: pattern["panels"][name] for name in pattern["panel_order"]}
    count, joined = {}, {}
    for name, panel in panels.items():
        for k, edge in enumerate(panel["edges"]):
            line = points(panel, edge, 200) / 100
            length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
            count[name, k] = max(round(length / h), 1)
    for stitch in pattern["stitches"]:
        a, b = ((side["panel"], side["edge"]) for side in stitch)
        joined[a], joined[b] = b, a
        count[b] = count[a]
    made, at = Charted(), {}  # the vertices of each edge
    parts = []
    for k, (name, panel) in enumerate(panels.items()):
        lines = [points(panel, e, count[name, i]) for i, e in enumerate(panel["edges"])]
        ring = np.concatenate([each[:-1] for each in lines]) / 100
        area = (ring * np.roll(ring, -1, axis=0)[:, ::-1] * [1, -1]).sum()
        x, tri = filled(ring, h)
        # a panel that is drawn clockwise shows its wrong side
        where = sewn.run.positions(sewn.run.bodies[k], sewn.steps)
        parts.append(
            (name, x, tri, place(x, flat[k][0][:, :2], flat[k][1], where), area < 0)
        )
        first = 0
        for i, line in enumerate(lines):
            n = len(line) - 1
            at[name, i] = [(first + j) % len(ring) for j in range(n + 1)]
            first += n
    root: dict[tuple[str, int], tuple[str, int]] = {}

    def top(v: tuple[str, int]) -> tuple[str, int]:
        while v in root:
            v = root[v]
        return v

    for a, b in joined.items():
        for u, v in zip(at[a], reversed(at[b]), strict=True):
            p, q = top((a[0], u)), top((b[0], v))
            if p != q:
                root[max(p, q)] = min(p, q)
    places: dict[tuple[str, int], list[Array]] = {}
    for name, x, _, where, _ in parts:
        for v in range(len(x)):
            places.setdefault(top((name, v)), []).append(where[v])
    number = {key: k for k, key in enumerate(places)}
    made.x = [np.mean(each, axis=0).tolist() for each in places.values()]
    for name, x, tri, _, turned in parts:
        uv = len(made.uv)
        made.uv += (x * [-1, 1] if turned else x).tolist()
        order = [2, 1, 0] if turned else [0, 1, 2]
        made.charts[name] = [
            [(number[top((name, v))], uv + v) for v in face]
            for face in tri[:, order].tolist()
        ]
    return made


def place(x: Array, flat: Array, tri: Array, where: Array) -> Array:
    """Where points of a panel are in space, by the three particles around them."""
    a, b, c = (flat[tri[:, i]] for i in range(3))

    def cross(p: Array, q: Array) -> Array:
        found: Array = p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
        return found

    area = cross(b - a, c - a)
    found = np.zeros((len(x), 3))
    for k, p in enumerate(x):
        u, v = cross(b - p, c - p) / area, cross(c - p, a - p) / area
        weight = np.stack([u, v, 1 - u - v], 1)
        best = int(weight.min(1).argmax())
        found[k] = weight[best] @ where[tri[best]]
    return found
