# SPDX-License-Identifier: Apache-2.0
"""The ground that a sheet slides down: a mesh, and the smooth surface that a sheet of some
size feels of it. spec/validation.md §9"""
import math
import os
from math import cos, pi, sin
from pathlib import Path

import numpy as np
from drape.export.run import read_ply

from validate.world import NAN, cross, dot, total

FAR = 0.02  # m: what is farther is another part of the statue


def length(a):
    return np.sqrt(dot(a, a))


class Mesh:
    """Vertices and triangles; corners: [3, triangles, 3]; area: along the normals."""

    def __init__(self, x, triangles):
        self.x, self.triangles = x, triangles
        self.corners = np.stack([x[triangles[:, k]] for k in range(3)])
        a, b, c = self.corners
        self.area = cross((b - a) / 2, c - a)

    def near(self, at, reach):
        """The triangles whose first vertex is within `reach` of a place."""
        chosen = self.triangles[length(at - self.corners[0]) < reach]
        number = {}
        for v in chosen.ravel().tolist():
            number.setdefault(v, len(number))
        return Mesh(self.x[list(number)],
                    np.array([[number[v] for v in t] for t in chosen.tolist()], np.int32))

    def lift(self, x, n, gap):
        """How far x is to be moved along n to be `gap` above the triangles; NaN: the line
        meets none that is near."""
        to = self.corners - x
        sides = [cross(to[k], to[(k + 1) % 3]) for k in range(3)]
        area = sides[0] + sides[1] + sides[2]
        inside = np.minimum.reduce([dot(side, n) for side in sides])
        facing = dot(area, n)
        lift = (dot(area, to[0]) + gap * length(area)) / facing
        found = lift[(inside >= 0) & (facing > 0) & (abs(lift) < FAR)]
        return found.max() if len(found) else NAN


class Facets(Mesh):
    """The mesh itself, on which points slide. ends: a floor's impulse on a point is along
    its normal where the step ends, not where it starts: as of edges, whose sides have
    normals of their own."""
    ends = True

    def __init__(self, mesh):
        super().__init__(mesh.x, mesh.triangles)
        a, b, c = self.corners
        self.reach = FAR + np.fmax(length(b - a), length(c - a))

    def height(self, x):
        """How high x is over the nearest facet, m, and the normal there: that of the facet
        where x is behind it. NaN: nothing is near."""
        some = length(x - self.corners[0]) <= self.reach
        at, area = self.corners[:, some], self.area[some]
        if not len(area):
            return NAN, None
        # below x, or on an edge that has x on its outer side
        high = dot(x - at[0], area) / dot(area, area)
        place, best = x - high[:, None] * area, np.full(len(area), math.inf)
        for k in range(3):
            side, to = at[(k + 1) % 3] - at[k], x - at[k]
            part = np.fmin(1, np.fmax(0, dot(to, side) / dot(side, side)))
            edge = at[k] + part[:, None] * side
            away = length(edge - x)
            better = (dot(to, cross(side, area)) > 0) & (away < best)
            place[better], best[better] = edge[better], away[better]
        distance = length(place - x)
        t = int(np.argmin(distance))
        if not distance[t] < FAR:
            return NAN, None
        if total((x - place[t]) * area[t]) > 0:
            return distance[t], (x - place[t]) / distance[t]
        return -distance[t], area[t] / length(area[t])


class Smooth:
    """The smooth surface that a sheet of this side feels of a mesh: heights over its
    pieces, which lie in the boxes of a grid whose side is the radius within which they
    count."""
    ends = False

    def __init__(self, mesh, side):
        self.mesh = mesh
        # By the weights of `height` a disc of this radius has the moments of a square of
        # this side.
        self.radius = side * math.sqrt(10.0 / 12)
        # a margin of more than one box around the mesh
        self.lo = mesh.x.min(0) - 2 * self.radius
        self.boxes = ((mesh.x.max(0) - self.lo) / self.radius).astype(int) + 3
        pieces = self.pieces()
        at = ((pieces[:, :3] - self.lo) / self.radius).astype(int)
        box = (at[:, 0] * self.boxes[1] + at[:, 1]) * self.boxes[2] + at[:, 2]
        self.piece = pieces[np.argsort(box, kind="stable")]
        self.size = length(self.piece[:, 3:])
        count = np.bincount(box, minlength=self.boxes.prod())
        self.first = np.concatenate([[0], np.cumsum(count)])

    def pieces(self):
        """Middles and areas of pieces of triangles: their sides are cut so that they are
        small beside the radius."""
        a, b, c = self.mesh.corners
        longest = np.maximum.reduce([length(b - a), length(c - b), length(a - c)])
        cuts = 1 + (5 * longest / self.radius).astype(int)
        first = np.concatenate([[0], np.cumsum(cuts * cuts)])
        out = np.empty((first[-1], 6))
        for n in np.unique(cuts).tolist():
            some = np.flatnonzero(cuts == n)
            for q, (i, j) in enumerate((i, j) for i in range(n)
                                       for j in range(2 * (n - i) - 1)):
                # every second piece of a row is upside down
                s = (i + (2.0 if j % 2 else 1.0) / 3) / n
                r = (j // 2 + (2.0 if j % 2 else 1.0) / 3) / n
                at = first[some] + q
                out[at, :3] = (1 - s - r) * a[some] + s * b[some] + r * c[some]
                out[at, 3:] = self.mesh.area[some] / (n * n)
        return out

    def height(self, x):
        """How high x is over the surface, m, and the normal there. NaN: nothing is
        near."""
        place = (x - self.lo) / self.radius
        if not (place >= 1).all() or not (place < self.boxes - 1).all():
            return NAN, None
        a, b, c = place.astype(int).tolist()
        rows = [(i * int(self.boxes[1]) + j) * int(self.boxes[2]) + c
                for i in range(a - 1, a + 2) for j in range(b - 1, b + 2)]
        some = [slice(self.first[row - 1], self.first[row + 2]) for row in rows]
        piece = np.concatenate([self.piece[each] for each in some])
        size = np.concatenate([self.size[each] for each in some])
        d, square = x - piece[:, :3], self.radius * self.radius
        near = 1 - dot(d, d) / square
        counts = near > 0
        d, area, size, near = d[counts], piece[counts, 3:], size[counts], near[counts]
        if not len(near):
            return NAN, None
        weight, high = near * near * near, dot(area, d)
        by = (-6 * near * near / square)[:, None] * d
        # of weights, of weights times the place's height over a piece's plane, and the
        # gradients of both
        sums = total(np.column_stack([
            weight * size, weight * high, by * size[:, None],
            by * high[:, None] + weight[:, None] * area]))
        height = sums[1] / sums[0]
        normal = (sums[5:] - height * sums[2:5]) / sums[0]
        # The mean of heights need not grow by 1 m a metre: its zero counts, and near it
        # height over gradient is the distance.
        gradient = length(normal)
        return height / gradient, normal / gradient

    def put(self, x, height):
        """x, moved along normals to this height; None: it does not get there."""
        for _ in range(20):
            found, n = self.height(x)
            off = found - height
            if abs(off) < 1e-9:
                return x
            if n is None:
                return None
            x = x - off * n
        return None


def noise(k):
    """A number in 0 … 1 that looks random: Thomas Wang's hash of 32 bits."""
    k = (k ^ 61) ^ (k >> 16)
    k = k * 9 & 0xffffffff
    k ^= k >> 4
    k = k * 0x27d4eb2d & 0xffffffff
    return (k ^ (k >> 15)) / 4294967296.0


def boulder(facet, rough):
    """The flank of a boulder of 1 m radius with 12 waves, each with a length of 0.35 to 0.7
    m and a curvature of 0.7/m at most; in uneven triangles of about this side, narrower
    towards the top, whose corners are moved out or in by up to `rough` m. By rows, down
    from its top, and columns, about its axis."""
    waves = []
    for k in range(12):
        up, round_ = 2 * noise(4 * k) - 1, 2 * pi * noise(4 * k + 1)
        flat = math.sqrt(1 - up * up)
        rate = 2 * pi / (0.35 * (1 + noise(4 * k + 2)))
        waves.append((flat * cos(round_), up, flat * sin(round_), rate,
                      10 * noise(4 * k + 3)))
    rows, m, x = int(1.5 / facet), int(2.4 / facet), []
    for k in range(m * rows):
        seed = 100 + 3 * k
        i = facet * (k // m + 0.6 * noise(seed))
        j = facet * (k % m + 0.6 * noise(seed + 1))
        p, q, r = sin(i) * cos(j), cos(i), sin(i) * sin(j)
        radius = 1
        for a, b, c, rate, phase in waves:
            radius += 0.7 / (rate * rate) * sin(rate * (a * p + b * q + c * r) + phase)
        radius += rough * (2 * noise(seed + 2) - 1)
        x.append((radius * p, radius * q, radius * r))
    triangles = []
    for k in range(m * (rows - 1)):
        if k % m + 1 < m:
            p, q, turned = k, k + m, noise(7 + 3 * k) < 0.5
            triangles += [(p, q + 1 if turned else p + 1, q),
                          (p + 1, q + 1, p if turned else q)]
    return Mesh(np.array(x), np.array(triangles, np.int32))


def statue(name, size):
    """NAME.ply, so large that its largest extent is `size`, from where the tool looks for
    meshes: the folders of $DRAPE_MODELS, of which an empty name is the current folder,
    models/ of $DRAPE_DATA, or of build/data, and build/models. None: none has it."""
    folders = os.environ.get("DRAPE_MODELS", "").split(":")
    folders += [f"{os.environ.get('DRAPE_DATA') or 'build/data'}/models", "build/models"]
    for folder in folders:
        path = Path(folder or ".") / f"{name}.ply"
        if path.exists():
            x, triangles = read_ply(path)
            x = x.astype(float)
            return Mesh(x * (size / np.ptp(x, axis=0).max()), triangles)
    return None
