# SPDX-License-Identifier: Apache-2.0
"""Cusick's drape test, BS 5058, and each fabric's drape coefficient, bending length and
shear beside what drape tests find. spec/validation.md §6, §7"""
import math

import drape
import numpy as np

from validate.property import SIZES, Property, measure
from validate.theory import elastica
from validate.world import G, NAN, energy_of, lay, rest, rest_by, sheet

RADIUS, SUPPORT = 0.15, 0.09  # m
SIDE, PIXEL = 1280, 0.25e-3  # of the shadow's map: m a pixel


def fill(shadow, corners):
    """Marks the pixels whose middles lie in a triangle."""
    x = [(corner[0] / PIXEL + SIDE // 2) - 0.5 for corner in corners]
    z = [(corner[2] / PIXEL + SIDE // 2) - 0.5 for corner in corners]
    for row in range(math.ceil(max(min(z), 0)), min(math.floor(max(z)), SIDE - 1) + 1):
        found = []
        for k in range(3):
            m = (k + 1) % 3
            if (z[k] < row) == (z[m] < row) and z[k] != row:
                continue
            t = 0 if z[m] == z[k] else (row - z[k]) / (z[m] - z[k])
            if 0 <= t <= 1:
                found.append(x[k] + t * (x[m] - x[k]))
        if found:
            lo, hi = math.ceil(max(min(found), 0)), math.floor(max(found))
            shadow[row, lo:max(hi + 1, lo)] = True


def folds_of(shadow, bins=360):
    """Folds of the outline: how often its radius rises through the mean, by more than a
    hundredth of it."""
    z, x = np.nonzero(shadow)
    x, z = x - SIDE / 2 + 0.5, z - SIDE / 2 + 0.5
    at = (bins * (np.arctan2(z, x) / (2 * math.pi) + 0.5)).astype(int)
    radius = np.zeros(bins)
    np.maximum.at(radius, np.minimum(at, bins - 1), np.hypot(x, z))
    off = radius / radius.mean() - 1
    sides = np.sign(off)[abs(off) > 0.01]
    return int(np.count_nonzero((sides > 0) & (np.roll(sides, 1) < 0)))


def shadow_of(s):
    """The shadow of a draped disc about x = z = 0, seen along gravity: its area, m², and
    the folds of its outline."""
    shadow = np.zeros((SIDE, SIDE), bool)
    m, x = s.m, s.x.tolist()
    for p in s.cells().tolist():
        fill(shadow, (x[p], x[p + 1], x[p + m + 1]))
        fill(shadow, (x[p], x[p + m + 1], x[p + m]))
    return np.count_nonzero(shadow) * PIXEL * PIXEL, folds_of(shadow)


def disc(v, material, h):
    """A flat disc of cells of side h between the plates of the support: particles on it
    are pinned. The clamp is half a row before the last pinned one, and rows are h apart
    along the axes and h/√2 along diagonals."""
    half = int(RADIUS / h) + 1
    side = 2 * half + 1
    s = sheet(v, side, side, h)
    lay(s)
    for name, number in material.items():
        setattr(s.material, name, number)
    s.scene.settings.tolerance = 1e-4  # of steps towards rest
    s.x[:, 0] -= half * h
    s.x[:, 2] += half * h
    r = np.hypot(s.x[:, 0], s.x[:, 2])
    s.hole[:] = r > RADIUS + h / 4
    for p, x in enumerate(s.x):
        if r[p] <= SUPPORT + 0.85 * h:
            s.pin(p % side, p // side)
        # waves of many numbers, so that no number of folds is given
        turn, wave = math.atan2(x[2], x[0]), 0
        for k in range(2, 12):
            wave += math.cos(k * turn + k * k)
        x[1] = 2e-3 * max(0, r[p] - SUPPORT) * wave
    return s


def refine(s, h, coarse, g):
    """Sets a sheet as the coarser one lies: from the nearest particle there, along its
    tangents."""
    m, c = s.m, coarse.m
    there = np.zeros((c + 8, c + 8), bool)  # with a margin, in which nothing is
    there[4:-4, 4:-4] = coarse.hole.reshape(c, c) == 0
    near = [(k % 7 - 3, k // 7 - 3) for k in range(49)]
    for p in np.flatnonzero(s.hole == 0):
        u = (p % m - m // 2) * h / g + c // 2
        w = (p // m - m // 2) * h / g + c // 2
        best, least = None, math.inf
        for di, dj in near:
            i, j = int(u) + di, int(w) + dj
            d = np.hypot(u - i, w - j)
            if there[j + 4, i + 4] and d < least:
                best, least = (i, j), d
        if best is None:
            continue
        i, j = best
        e, a, n, b = (int(there[j + 4 + y, i + 4 + x])
                      for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)))
        at = i + c * j
        du = coarse.x[at + e] - coarse.x[at - a]
        dw = coarse.x[at + n * c] - coarse.x[at - b * c]
        s.x[p] = (coarse.x[at] + ((u - i) * du / (e + a) if e + a else 0) +
                  ((w - j) * dw / (n + b) if n + b else 0))


def drape_of(v, material, cells):
    """The drape coefficient, %, and the folds at each size of cells, the coarsest first;
    each starts as the one before it lay. NaN: no rest was found."""
    found, last = [], None
    for k, h in enumerate(cells):
        s = disc(v, material, h)
        whole, plate = shadow_of(s)[0], math.pi * SUPPORT * SUPPORT
        if last:
            refine(s, h, last, cells[k - 1])
        rests = rest_by(s, 2, 0.15 if last else 1 / 60, 2e-5 if v.bits == 64 else 1e-4)
        area, folds = shadow_of(s)
        found.append((100 * (area - plate) / (whole - plate), folds) if rests else
                     (NAN, NAN))
        last = s
    return found


def cusick(v):
    if v.quick and v.bits == 32:
        return
    cells = (8e-3, 4e-3, 2e-3, 1e-3) if v.fine else (12e-3, 8e-3, 4e-3, 3e-3)
    cells = cells[:2 if v.quick else SIZES if v.bits == 64 else 3]
    found = dict(zip(cells, drape_of(v, {"density": 0.15, "shear": 50}, cells)))
    measure(v, [Property("drape coefficient; D = 1e-5; change by cells", "%", NAN,
                         10 if v.quick else 1, v.fine or v.quick),
                Property("folds; D = 1e-5", "1", NAN, NAN)], cells, found.get)


# Published bands of the drape coefficient, %; the middle and half the width of a band are
# theory and bar of the row.
BANDS = {"silk": (20, 40), "cotton": (60, 76), "wool": (40, 70), "denim": (70, 90)}


def drape_rows(v, name, material):
    low, high = BANDS.get(name, (NAN, NAN))
    cells = 12e-3, 8e-3, 6e-3, 4e-3
    found = dict(zip(cells, drape_of(v, material, cells)))
    measure(v, [Property(f"drape coefficient; {name}", "%", (low + high) / 2,
                         (high - low) / 2),
                Property(f"folds; {name}", "1", NAN, NAN)], cells, found.get)


def hang(v, material, length, cells):
    """The angle below the level, degrees, at which a ribbon in warp of twice Peirce's
    bending length hangs: the test of BS 3356 cuts its strip so that this is 41.5. Two
    rows are pinned, as in strips.py."""
    h = length / (cells - 0.5)
    s = sheet(v, cells + 1, 2, h)
    for name, number in material.items():
        setattr(s.material, name, number)
    lay(s)
    for k in range(4):
        s.pin(k % 2, k // 2)
    if not rest(s, 1e-7 * length):
        return NAN
    return math.atan2(-s.x[cells, 1], s.x[cells, 0] - h / 2) * 180 / math.pi


def shear_of(v, material, h, angle=1e-3):
    """The shear modulus, N/m: of the energy of a sheet sheared by 0.1 %."""
    s = sheet(v, 11, 11, h)
    for name in "stretch", "shear", "bend":
        setattr(s.material, name, material[name])
    x, y = s.x[:, 0].copy(), s.x[:, 1].copy()
    s.x[:, 0] = x + angle / 2 * y
    s.x[:, 1] = y + angle / 2 * x
    return 2 * energy_of(s) / (100 * h * h * angle * angle)


def fabrics(v):
    if v.bits == 32:
        return
    for name, fabric in list(drape.materials().items())[:1 if v.quick else None]:
        material = {each: getattr(fabric.material, each)
                    for each in ("density", "stretch", "shear", "bend")}
        bending = math.cbrt(material["bend"] / (G * material["density"]))
        p = Property(f"Peirce's bending length; {name}", "mm", NAN, NAN)
        p.add(0, 1e3 * bending)
        v.end(p)
        angle = Property(f"angle at twice Peirce's bending length; {name}", "degrees",
                         math.atan(elastica(8)) * 180 / math.pi, 0.01, True, True)
        shear = Property(f"shear modulus at 0.1 %; {name}", "N/m", material["shear"],
                         0.005, True, True)
        for n, h in list(zip((8, 12, 25, 50), (12e-3, 8e-3, 6e-3, 4e-3)))[
                :2 if v.quick else SIZES]:
            angle.add(2 * bending / n, hang(v, material, 2 * bending, n))
            shear.add(h, shear_of(v, material, h))
        v.end(angle)
        v.end(shear)
        if not v.quick:
            drape_rows(v, name, material)
