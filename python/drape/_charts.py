# SPDX-License-Identifier: Apache-2.0
"""The UV charts of a mesh, their outlines, and which parts of these are seams."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._obj import Obj
from .errors import SceneError

Array = NDArray[Any]

# rad: where an outline turns by more an edge of the pattern ends, so that cells have a
# particle in the corner.
TURN = np.radians(30)


class Turn(NamedTuple):
    """An edge of an outline, by the numbers of the edges that follow it."""

    chart: int
    face: int
    a: int
    b: int


class Sheet:
    """The charts of a mesh. A *corner* here is a vertex of the mesh at a place in UV;
    one that faces share is one corner.

    Attributes:
        names: [charts]
        mirrored: [charts] whether the UVs show its wrong side
        vertex: [corners] of the mesh
        plane: [corners, 2] UV, of mirrored charts with -u: the right side is up
    """

    def __init__(self, obj: Obj, x: Array) -> None:
        self.obj, self.x, self.file = obj, x, obj.file
        self._refuse_bare()
        self._find_corners()
        self._find_edges()
        self._find_charts()
        self._find_outlines()
        self._find_partners()

    def refuse(self, where: str, why: str) -> SceneError:
        return SceneError(f"{self.file}: {where}: {why}")

    def faces(self, k: int) -> Array:
        """The faces of chart k."""
        return np.flatnonzero(self.chart == k)

    def corners(self, k: int) -> Array:
        """The corners of chart k."""
        return np.flatnonzero(self.corner_chart == k)

    def triangles(self, k: int) -> Array:
        """The faces of chart k as triangles of corners with area in UV."""
        found: Array = self.tri[self.chart[self.tri_face] == k]
        return found

    def _refuse_bare(self) -> None:
        bare = np.flatnonzero(self.obj.texture < 0)
        if len(bare):
            face = int(self.obj.face_of[bare[0]])
            missing = len(np.unique(self.obj.face_of[bare]))
            if missing == len(self.obj.face_at):
                raise SceneError(
                    f"{self.file}: it has no UVs; a garment's charts are its panels: "
                    "unwrap it first, with seams where the cloth is sewn"
                )
            raise self.refuse(f"face {face + 1}", "it has no UVs, where others have")

    def _find_corners(self) -> None:
        """Corners, and the faces' area in UV, whose sign says which side is up."""
        obj = self.obj
        uv = obj.uv[obj.texture] + 0.0  # -0 is 0
        key = np.column_stack([obj.vertex, uv])
        rows, number = np.unique(key, axis=0, return_inverse=True)
        self.corner = number.reshape(-1)  # of each corner of a face
        self.vertex = rows[:, 0].astype(np.int64)
        self.plane = rows[:, 1:].copy()
        start = obj.start
        self.following = np.arange(len(uv)) + 1
        self.following[start[1:] - 1] = start[:-1]
        p = uv - uv[start[:-1]][obj.face_of]
        q = p[self.following]
        area = np.add.reduceat(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0], start[:-1]) / 2
        size = np.add.reduceat(((q - p) ** 2).sum(1), start[:-1])
        flat = np.flatnonzero(~(np.abs(area) > 1e-9 * size))
        if len(flat):
            raise self.refuse(
                f"face {flat[0] + 1}", "it has no area in UV, or crosses itself there"
            )
        self.sign = np.where(area > 0, 1, -1)

    def _find_edges(self) -> None:
        """Pairs of faces that an edge joins: its corners are the same of both, and
        they lie on its two sides in UV."""
        face, a = self.obj.face_of, self.corner
        b = a[self.following]
        lo, hi = np.minimum(a, b), np.maximum(a, b)
        order = np.lexsort((face, hi, lo))
        same = (lo[order][1:] == lo[order][:-1]) & (hi[order][1:] == hi[order][:-1])
        many = np.flatnonzero(same[1:] & same[:-1])
        if len(many):
            three = face[order[many[0] : many[0] + 3]] + 1
            raise self.refuse(
                f"face {three[0]}",
                f"an edge is of faces {three[1]} and {three[2]}, too; expected two",
            )
        first = np.flatnonzero(same)
        one, two = order[first], order[first + 1]
        # faces that pass an edge in one direction lie on its two sides in UV only
        # where one shows its wrong side; else they lie on each other, as charts do
        # that are sewn there
        along, alike = a[one] == a[two], self.sign[face[one]] == self.sign[face[two]]
        wrong = np.flatnonzero(along & ~alike)
        if len(wrong):
            here = face[one[wrong[0]]] + 1, face[two[wrong[0]]] + 1
            raise self.refuse(
                f"face {here[1]}",
                f"it passes its edge to face {here[0]} in the same direction: one of "
                "them is turned over",
            )
        joined = alike & ~along
        self.joined = np.stack([one[joined], two[joined]], 1)
        self.a, self.b = a, b

    def _find_charts(self) -> None:
        """Charts are what joined edges connect."""
        face = self.obj.face_of
        count = len(self.obj.face_at)
        pairs = face[self.joined]
        chart = np.arange(count)
        while True:  # each takes the least number around it, and its number's number
            least = chart.copy()
            for one, two in ((0, 1), (1, 0)):
                np.minimum.at(least, chart[pairs[:, one]], chart[pairs[:, two]])
            least = least[least]
            new = least[chart]
            if (new == chart).all():
                break
            chart = new
        first, chart = np.unique(chart, return_inverse=True)
        self.chart = chart.reshape(-1)
        self.mirrored = self.sign[first] < 0
        self.names = self._name(first)
        self.corner_chart = np.full(len(self.vertex), -1)
        self.corner_chart[self.corner] = self.chart[face]
        twice = np.flatnonzero(self.corner_chart[self.corner] != self.chart[face])
        if len(twice):  # charts that meet in a corner have one each
            self._part_corners()
        self.plane[self.mirrored[self.corner_chart], 0] *= -1
        self._triangulate()

    def _part_corners(self) -> None:
        """Gives each chart corners of its own."""
        key = np.column_stack([self.corner, self.chart[self.obj.face_of]])
        rows, number = np.unique(key, axis=0, return_inverse=True)
        self.corner = number.reshape(-1)
        self.vertex, self.plane = self.vertex[rows[:, 0]], self.plane[rows[:, 0]]
        self.corner_chart = rows[:, 1]
        self.a, self.b = self.corner, self.corner[self.following]

    def _name(self, first: Array) -> list[str]:
        """Names of charts by the groups of their first faces."""
        names: list[str] = []
        for face in first.tolist():
            base = self.obj.names[face] or "chart"
            name, k = base, 2
            while name in names:
                name, k = f"{base} {k}", k + 1
            names.append(name)
        return names

    def _triangulate(self) -> None:
        """Cuts polygons to triangles in the plane."""
        start, size = self.obj.start, np.diff(self.obj.start)
        tri, face = [], []
        for n in (3, 4):
            which = np.flatnonzero(size == n)
            at = self.corner[start[which][:, None] + np.arange(n)]
            if n == 3:
                tri.append(at)
                face.append(which)
                continue
            # by the diagonal whose smaller triangle is the larger
            cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]]
            least = [np.minimum(*(self._area(at[:, t]) for t in cut)) for cut in cuts]
            better = (least[1] > least[0])[:, None]
            for one, two in zip(*cuts, strict=True):
                tri.append(np.where(better, at[:, two], at[:, one]))
                face.append(which)
        for k in np.flatnonzero(size > 4).tolist():
            ears = self._ears(self.corner[start[k] : start[k + 1]].tolist())
            tri.append(np.array(ears, np.int64).reshape(-1, 3))
            face.append(np.full(len(ears), k))
        self.tri, self.tri_face = np.concatenate(tri), np.concatenate(face)
        area = self._area(self.tri)
        turned = np.flatnonzero(area < 0)
        if len(turned):
            number = self.tri_face[turned[0]]
            chart = self.names[self.chart[number]]
            raise self.refuse(
                f"chart {chart}", f"face {number + 1} crosses itself in UV"
            )
        self.tri, self.tri_face = self.tri[area > 0], self.tri_face[area > 0]

    def _area(self, tri: Array) -> Array:
        p = self.plane[tri]
        a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        found: Array = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
        return found

    def _ears(self, ring: list[int]) -> list[list[int]]:
        """The triangles of a polygon: corner by corner, the one that is cut off has no
        other corner in it, and is the best shaped."""
        found = []
        while len(ring) > 3:
            best, most = 0, -np.inf
            for k in range(len(ring)):
                ear = [ring[k - 1], ring[k], ring[(k + 1) % len(ring)]]
                p = self.plane[ear]
                d = np.roll(p, -1, axis=0) - p
                area = d[0, 0] * d[1, 1] - d[0, 1] * d[1, 0]
                shape = area / (d**2).sum()
                if shape > most and not self._holds(p, d, ring, ear):
                    best, most = k, shape
            found.append([ring[best - 1], ring[best], ring[(best + 1) % len(ring)]])
            del ring[best]
        return [*found, ring]

    def _holds(self, p: Array, d: Array, ring: list[int], ear: list[int]) -> bool:
        others = self.plane[[c for c in ring if c not in ear]]
        to = others[:, None] - p
        inside = (d[:, 0] * to[:, :, 1] - d[:, 1] * to[:, :, 0] > 0).all(1)
        return bool(inside.any())

    def strain(
        self, k: int, scale: float | None
    ) -> tuple[float, float, tuple[int, float]]:
        """Returns of chart k the metres of a unit of UV; its strain, the root mean
        square over its area of the larger principal strain of each face; and the face
        that is strained most, with its strain."""
        mine = self.chart[self.tri_face] == k
        tri = self.tri[mine]
        p, x = self.plane[tri], self.x[self.vertex[tri]]
        with np.errstate(all="ignore"):  # what is no number is refused
            area, f = _stretches(p, x)
            return self._strain(k, scale, area, f, self.tri_face[mine])

    def _strain(
        self, k: int, scale: float | None, area: Array, f: Array, face: Array
    ) -> tuple[float, float, tuple[int, float]]:
        """The same of triangles by their areas in UV and their principal stretches."""
        if scale is None:
            space = float((f[:, 0] * f[:, 1] * area).sum())
            # digits beyond those of most files would put cells beside their grid
            scale = float(f"{np.sqrt(space / area.sum()):.6g}")
        if not scale > 0:
            raise self.refuse(f"chart {self.names[k]}", "it has no area in space")
        most = np.abs(f / scale - 1).max(1)
        worst = int(most.argmax())
        mean = float(np.sqrt((most**2 * area).sum() / area.sum()))
        return scale, mean, (int(face[worst]), float(most[worst]))

    def _find_outlines(self) -> None:
        """The edges that are of one face alone, in the order of the outline: edge k
        goes from corner edge_a[k] to edge_b[k], and edge `after[k]` follows."""
        alone = np.ones(len(self.a), bool)
        alone[self.joined] = False
        self.rim = np.flatnonzero(alone)
        self.edge_a, self.edge_b = self.a[self.rim], self.b[self.rim]
        self.edge_face = self.obj.face_of[self.rim]
        self.edge_chart = self.chart[self.edge_face]
        count = np.bincount(self.edge_a, minlength=len(self.vertex))
        pinched = np.flatnonzero(count > 1)
        if len(pinched):
            corner = pinched[0]
            raise self.refuse(
                f"chart {self.names[self.corner_chart[corner]]}",
                f"its outline touches itself in vertex {self.vertex[corner] + 1}",
            )
        begins = np.full(len(self.vertex), -1)
        begins[self.edge_a] = np.arange(len(self.rim))
        self.after = begins[self.edge_b]
        self.before = np.empty_like(self.after)
        self.before[self.after] = np.arange(len(self.rim))
        self.loops = [self._outline(k) for k in range(len(self.names))]

    def _outline(self, k: int) -> Array:
        """The edges of chart k's outline in their order."""
        mine = np.flatnonzero(self.edge_chart == k)
        loops: list[list[int]] = []
        seen: set[int] = set()
        after = self.after.tolist()
        for first in mine.tolist():
            loop = []
            while first not in seen:
                seen.add(first)
                loop.append(first)
                first = after[first]
            if loop:
                loops.append(loop)
        if not loops:
            raise self.refuse(
                f"chart {self.names[k]}", "it has no outline: cut it open by a UV seam"
            )
        if len(loops) > 1:
            hole = min(loops, key=self._enclosed)
            raise self.refuse(
                f"chart {self.names[k]}",
                f"it has a hole, beside face {self.edge_face[hole[0]] + 1}; a panel "
                "has one outline: cut the chart from the hole to its outline by a UV "
                "seam",
            )
        return np.array(loops[0])

    def _enclosed(self, loop: list[int]) -> float:
        p, q = self.plane[self.edge_a[loop]], self.plane[self.edge_b[loop]]
        return float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())

    def _find_partners(self) -> None:
        """partner: [edges] the edge that it is sewn to, as both have the same ends in
        space; -1: none. along: whether both pass it in the same direction."""
        x = self.x[self.vertex] + 0.0
        place = np.unique(x, axis=0, return_inverse=True)[1].reshape(-1)
        self.place = place
        a, b = place[self.edge_a], place[self.edge_b]
        lo, hi = np.minimum(a, b), np.maximum(a, b)
        self.partner = np.full(len(a), -1)
        self.along = np.zeros(len(a), bool)
        order = np.lexsort((hi, lo))
        order = order[lo[order] != hi[order]]
        same = (lo[order][1:] == lo[order][:-1]) & (hi[order][1:] == hi[order][:-1])
        many = np.flatnonzero(same[1:] & same[:-1])
        if len(many):
            self._refuse_many(order[many[0] : many[0] + 3])
        first = np.flatnonzero(same)
        one, two = order[first], order[first + 1]
        self.partner[one], self.partner[two] = two, one
        self.along[one] = self.along[two] = a[one] == a[two]
        self._refuse_inner(place, lo, hi)
        self._refuse_missing()

    def _refuse_many(self, three: Array) -> None:
        names = [self.names[self.edge_chart[k]] for k in three]
        face = [int(self.edge_face[k]) + 1 for k in three]
        raise self.refuse(
            f"chart {names[0]}",
            f"an edge of face {face[0]} is sewn to face {face[1]} of chart {names[1]} "
            f"and to face {face[2]} of chart {names[2]}; expected one seam an edge",
        )

    def _refuse_inner(self, place: Array, lo: Array, hi: Array) -> None:
        """An outline that lies on an edge inside of a chart cannot be sewn to it."""
        a, b = place[self.a[self.joined[:, 0]]], place[self.b[self.joined[:, 0]]]
        inner = np.minimum(a, b) * len(place) + np.maximum(a, b)
        wrong = np.flatnonzero(np.isin(lo * len(place) + hi, inner) & (lo != hi))
        if len(wrong):
            k = wrong[0]
            raise self.refuse(
                f"chart {self.names[self.edge_chart[k]]}",
                f"an edge of face {self.edge_face[k] + 1} is on an edge inside of a "
                "chart; seams join outlines: divide that chart there by a UV seam",
            )

    def _refuse_missing(self) -> None:
        """An edge whose ends are those of two edges, end to end, that are sewn to
        nothing: a vertex is missing in it."""
        free = np.flatnonzero(self.partner < 0)
        ends: dict[int, list[int]] = {}
        for k in free.tolist():
            for corner in (self.edge_a[k], self.edge_b[k]):
                ends.setdefault(int(self.place[corner]), []).append(k)
        for k in free.tolist():
            a, b = int(self.edge_a[k]), int(self.edge_b[k])
            p, q = self.x[self.vertex[a]], self.x[self.vertex[b]]
            side = q - p
            for other in ends[int(self.place[a])]:
                c, d = int(self.edge_a[other]), int(self.edge_b[other])
                end = d if self.place[c] == self.place[a] else c
                to = self.x[self.vertex[end]] - p
                part = float(to @ side) / max(float(side @ side), 1e-300)
                off = float(np.linalg.norm(to - part * side))
                inside = 1e-3 < part < 1 - 1e-3
                if other != k and inside and off < 1e-3 * np.linalg.norm(side):
                    raise self.refuse(
                        f"chart {self.names[self.edge_chart[k]]}",
                        f"an edge of face {self.edge_face[k] + 1} has no vertex where "
                        f"chart {self.names[self.edge_chart[other]]} has vertex "
                        f"{self.vertex[end] + 1}: a seam's sides have the same ones",
                    )

    def pattern(self, scale: Array, cell: float) -> dict[str, Any]:
        """Returns the sewing pattern; scale: [charts] m a unit of UV."""
        p, q = self.plane[self.edge_a], self.plane[self.edge_b]
        way = (q - p) * scale[self.edge_chart][:, None]
        length = np.hypot(way[:, 0], way[:, 1])
        short = np.flatnonzero(length < 1e-8)
        if len(short):
            raise self.refuse(
                f"chart {self.names[self.edge_chart[short[0]]]}",
                f"an edge of face {self.edge_face[short[0]] + 1} has no length in UV",
            )
        cuts = self._cuts(way)
        self._cut_long(cuts, length, cell)
        self._cut_round(cuts, length)
        run, panels = self._runs(cuts), {}
        edge_run = np.empty(len(self.rim), np.int64)
        numbers: list[tuple[int, int]] = []
        for chart, runs in enumerate(run):
            for k, edges in enumerate(runs):
                edge_run[edges] = len(numbers)
                numbers.append((chart, k))
            panels[self.names[chart]] = self._panel(runs, float(scale[chart]))
        stitches = []
        for mine in itertools.chain.from_iterable(run):
            other = int(self.partner[mine[0]])
            if other >= 0 and edge_run[mine[0]] < edge_run[other]:
                stitch: list[Any] = [
                    {"panel": self.names[chart], "edge": k}
                    for chart, k in (
                        numbers[edge_run[mine[0]]],
                        numbers[edge_run[other]],
                    )
                ]
                turned = ["right_wrong"] if self.along[mine[0]] else []
                stitches.append(stitch + turned)
        return {
            "pattern": {
                "panels": panels,
                "panel_order": self.names,
                "stitches": stitches,
            },
            "properties": {"units_in_meter": 1, "curvature_coords": "absolute"},
        }

    def _twin(self) -> Array:
        """[edges] of the place where an edge begins, the edge that begins there on the
        other side of the seam; -1: the seam ends, or there is none."""
        after, before, partner = self.after, self.before, self.partner
        here = np.arange(len(partner))
        p, q = partner[before], partner[here]
        both = (p >= 0) & (q >= 0)
        against = both & ~self.along & ~self.along[before]
        against &= (after[q] == p) & (q != before)
        turned = both & self.along & self.along[before] & (after[p] == q)
        twin: Array = np.where(against, p, -1)
        twin[turned] = q[turned]
        return twin

    def _cuts(self, way: Array) -> Array:
        """[edges] whether an edge of the pattern begins where this edge does: where a
        seam ends, and in corners, on both sides."""
        self.twin = self._twin()
        old = way[self.before]
        turn = np.arctan2(
            old[:, 0] * way[:, 1] - old[:, 1] * way[:, 0], (old * way).sum(1)
        )
        free = (self.partner < 0) & (self.partner[self.before] < 0)
        cuts = (np.abs(turn) > TURN) | ((self.twin < 0) & ~free)
        self._mark(cuts, np.flatnonzero(cuts))
        found: Array = cuts
        return found

    def _mark(self, cuts: Array, edges: Array) -> None:
        """Begins edges of the pattern there, on both sides of a seam."""
        cuts[edges] = True
        twin = self.twin[edges]
        cuts[twin[twin >= 0]] = True

    def _cut_round(self, cuts: Array, length: Array) -> None:
        """An outline that has no two corners gets them, half its length apart."""
        for loop in self.loops:
            for _ in range(2):
                where = np.flatnonzero(cuts[loop])
                if len(where) >= 2:
                    break
                first = int(where[0]) if len(where) else 0
                self._mark(cuts, loop[[first]])
                turned = np.roll(loop, -first)
                far = np.cumsum(length[turned])
                half = int(np.searchsorted(far, far[-1] / 2)) + 1
                self._mark(cuts, turned[[min(half, len(loop) - 1)]])

    def _cut_long(self, cuts: Array, length: Array, cell: float) -> None:
        """Cuts a seam where the same part of both sides' lengths is not the same
        place, by more than a quarter of a cell; pieces keep 4 cells."""
        work = [each for each in itertools.chain.from_iterable(self._runs(cuts))]
        while work:
            edges = work.pop()
            other = self.partner[edges]
            if other[0] < 0 or len(edges) < 2:
                continue
            s, t = np.cumsum(length[edges]), np.cumsum(length[other])
            off = np.abs(s / s[-1] - t / t[-1])[:-1] * max(s[-1], t[-1])
            room = np.minimum(s, s[-1] - s)[:-1] > 4 * cell
            off = np.where(room, off, 0)
            k = int(off.argmax())
            if off[k] > cell / 4:
                self._mark(cuts, edges[[k + 1]])
                work += [edges[: k + 1], edges[k + 1 :]]

    def _runs(self, cuts: Array) -> list[list[Array]]:
        """[charts] the runs of edges from cut to cut, in the outline's order."""
        found = []
        for loop in self.loops:
            where = np.flatnonzero(cuts[loop])
            if not len(where):
                found.append([loop])
                continue
            turned = np.roll(loop, -where[0])
            found.append(np.split(turned, where[1:] - where[0]))
        return found

    def _panel(self, runs: list[Array], scale: float) -> dict[str, Any]:
        """A panel of the pattern; its edges are lines where they are straight."""
        corners = [self.plane[self.edge_a[each[0]]] * scale for each in runs]
        edges = []
        for k, each in enumerate(runs):
            edge: dict[str, Any] = {"endpoints": [k, (k + 1) % len(runs)]}
            points = self.plane[self.edge_a[each[1:]]] * scale
            a, b = corners[k], corners[(k + 1) % len(runs)]
            if not _is_straight(a, b, points):
                params = points.tolist()
                edge["curvature"] = {"type": "polyline", "params": params}
            edges.append(edge)
        return {"vertices": [each.tolist() for each in corners], "edges": edges}


def _stretches(p: Array, x: Array) -> tuple[Array, Array]:
    """The areas of triangles p, [n, 3, 2], and by which lengths in them are multiplied
    in x, [n, 3, 3]: the most and the least, [n, 2]."""
    d, g = p[:, 2] - p[:, 0], p[:, 1] - p[:, 0]
    e, h = x[:, 2] - x[:, 0], x[:, 1] - x[:, 0]
    area = g[:, 0] * d[:, 1] - g[:, 1] * d[:, 0]
    u = (h * d[:, 1:] - e * g[:, 1:]) / area[:, None]  # by u, and by v
    v = (e * g[:, :1] - h * d[:, :1]) / area[:, None]
    a, b, c = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    middle, far = (a + c) / 2, np.hypot((a - c) / 2, b)
    squares = np.stack([middle + far, np.maximum(middle - far, 0)], 1)
    return area / 2, np.sqrt(squares)


def _is_straight(a: Array, b: Array, points: Array) -> bool:
    """Whether points are on the way from a to b, within a micrometre."""
    way = b - a
    length = float(np.hypot(*way))
    if not len(points):
        return True
    to = points - a
    off = np.abs(to[:, 0] * way[1] - to[:, 1] * way[0]) / length
    along = to @ way / length
    onward = (np.diff(along, prepend=0, append=length) > 0).all()
    return bool(onward and (off < 1e-6).all())
