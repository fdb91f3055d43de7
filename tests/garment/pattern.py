#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether `drape pattern` cuts what was drawn, by geometry of its own.

usage: tests/garment/pattern.py DRAPE [PATTERN.json...]

Patterns are made at random, or named. Of each panel the mesh must be one disk of
triangles that are not too small, with the area of the outline, and with its border
on the outline; how the file describes the outline must not matter.
"""
import cmath
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "app"))
from geometry import load  # noqa: E402: it lies in tests/app

UNIT = 100.0  # lengths in the files, to the metre


def run(drape, path, out, cell):
    """Runs the command; the tables' rows as dictionaries and what it printed."""
    done = subprocess.run([drape, "pattern", path, "--cell", str(cell), "--out", out],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, (path, done.stderr)
    tables = {}
    for name in ("panels", "edges", "seams", "points"):
        with open(os.path.join(out, name + ".csv"), newline="", encoding="utf-8") as f:
            tables[name] = list(csv.DictReader(f))
    return tables, done


def points(panel, edge, unit, n=400):
    """The points of an edge by its definition, as complex numbers, in m."""
    a, b = (complex(*panel["vertices"][v]) for v in edge["endpoints"])
    chord, bent = b - a, edge.get("curvature")
    t = [k / n for k in range(n + 1)]
    if bent is None:
        line = [a + chord * s for s in t]
    elif isinstance(bent, list) or bent["type"] == "quadratic":
        c = a + chord * complex(*(bent if isinstance(bent, list) else bent["params"][0]))
        line = [(1 - s) ** 2 * a + 2 * s * (1 - s) * c + s * s * b for s in t]
    elif bent["type"] == "cubic":
        c, d = (a + chord * complex(*p) for p in bent["params"])
        line = [(1 - s) ** 3 * a + 3 * s * (1 - s) ** 2 * c + 3 * s * s * (1 - s) * d +
                s ** 3 * b for s in t]
    elif bent["type"] == "polyline":
        corner = [a, *(a + chord * complex(*p) for p in bent["params"]), b]
        sides = len(corner) - 1  # which divide n
        at = [divmod(k * sides, n) for k in range(n)]
        line = [corner[i] + (corner[i + 1] - corner[i]) * r / n for i, r in at] + [b]
    else:
        radius, large, left = bent["params"]
        radius = max(radius, abs(chord) / 2)
        away = math.sqrt(radius ** 2 - abs(chord) ** 2 / 4) * 1j * chord / abs(chord)
        turns = []
        for centre in ((a + b) / 2 + away, (a + b) / 2 - away):
            angle = cmath.phase((b - centre) / (a - centre))
            angle += 2 * math.pi * ((angle < 0) if left else -(angle > 0))
            turns.append((angle, centre))
        # of the two circles the one whose arc is as large as it should be
        angle, centre = (max if large else min)(turns, key=lambda turn: abs(turn[0]))
        line = [centre + (a - centre) * cmath.exp(1j * angle * s) for s in t]
    return [p / unit for p in line]


def outline(panel, unit):
    """All points of a panel whose edges follow one another."""
    return [p for edge in panel["edges"] for p in points(panel, edge, unit)[:-1]]


def area(polygon):
    ends = zip(polygon, polygon[1:] + polygon[:1])
    return sum((a.conjugate() * b).imag for a, b in ends) / 2


def distance(p, polygon):
    """From a point to a polygon."""
    best = math.inf
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        d = b - a
        t = ((p - a) * d.conjugate()).real / abs(d) ** 2 if d else 0
        best = min(best, abs(p - a - min(max(t, 0), 1) * d))
    return best


def look(path, polygon, cell, row, far):
    """Checks the mesh of a panel; `far` cells may its border be off."""
    x, faces = load(path, "d")
    x = [complex(p[0], p[1]) for p in x]
    used, edges, total, least = set(), {}, 0, math.inf
    for face in faces:
        a, b, c = (x[v] for v in face)
        size = ((b - a).conjugate() * (c - a)).imag / 2
        total, least = total + size, min(least, size)
        used.update(face)
        for k in range(3):
            edge = face[k], face[(k + 1) % 3]
            assert edge not in edges, (path, "an edge twice")
            edges[edge] = face
    assert least >= 0.119 * cell ** 2, (path, least / cell ** 2)
    assert len(used) == len(x) == int(row["particles"]), (path, "particles")
    border = {a: b for a, b in edges if (b, a) not in edges}
    whole = len(border) + sum((b, a) in edges for a, b in edges) // 2
    assert len(x) - whole + len(faces) == 1, (path, "no disk")
    at, steps = next(iter(border)), 0
    first = at
    while steps == 0 or at != first:
        at, steps = border[at], steps + 1
    assert steps == len(border), (path, "a border in parts")
    want = abs(area(polygon))
    assert abs(total - float(row["cells_m2"])) < 1e-8 * want
    assert abs(want - float(row["area_m2"])) < 1e-5 * want, (path, want, row)
    assert abs(total / want - 1) < 1e-3, (path, total / want - 1)
    off = max(distance(x[v], polygon) for v in random.sample(sorted(border), 40))
    assert off < (far + 0.002) * cell, (path, off / cell)


def random_panel(seed):
    """A panel of 3 to 7 edges of any kind around a point, as GarmentCode has it.
    Its corners are of 40 degrees or more."""
    dice = random.Random(seed)
    while True:
        n = dice.randint(3, 7)
        turn = dice.random() * 2 * math.pi
        at = [cmath.rect(12 + 8 * dice.random(),
                         turn + 2 * math.pi * (k + 0.3 * dice.random()) / n)
              for k in range(n)]
        panel = {"vertices": [[p.real, p.imag] for p in at], "edges": [],
                 "translation": [1, 2, 3], "rotation": [0, 0, 0]}
        for k in range(n):
            edge = {"endpoints": [k, (k + 1) % n]}
            chord = abs(at[k] - at[(k + 1) % n])
            kind = dice.choice(("line", "quadratic", "cubic", "circle", "old",
                                "polyline"))
            y = [round(0.3 * dice.random() - 0.15, 3) for _ in range(2)]
            if kind == "quadratic":
                edge["curvature"] = {"type": kind, "params": [[0.4, y[0]]]}
            elif kind == "cubic":
                edge["curvature"] = {"type": kind, "params": [[0.3, y[0]], [0.7, y[1]]]}
            elif kind == "circle":
                edge["curvature"] = {"type": kind, "params": [
                    chord * (1 + dice.random()), 0, dice.randint(0, 1)]}
            elif kind == "polyline":
                edge["curvature"] = {"type": kind, "params": [
                    [0.3, y[0] / 4], [0.5, y[1] / 4], [0.7, y[0] / 4]]}
            elif kind == "old":
                edge["curvature"] = [0.5, y[0]]
            panel["edges"].append(edge)
        lines = [points(panel, edge, 1) for edge in panel["edges"]]
        corner = [math.pi - abs(cmath.phase((b[1] - b[0]) / (a[-1] - a[-2])))
                  for a, b in zip(lines, lines[1:] + lines[:1])]
        if min(corner) > math.radians(40):
            return panel


def write(path, panels, stitches=(), **properties):
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"pattern": {"panels": panels, "stitches": list(stitches)}, "properties":
                   {"units_in_meter": UNIT, **properties}}, file)


def reverse(panel):
    """The same panel with its edges in another order, each in the other direction,
    and its control points absolute."""
    other = dict(panel, edges=[])
    for edge in panel["edges"]:
        a, b = (complex(*panel["vertices"][v]) for v in edge["endpoints"])
        new = {"endpoints": edge["endpoints"][::-1]}
        bent = edge.get("curvature")
        if isinstance(bent, list):
            bent = {"type": "quadratic", "params": [bent]}
        if bent and bent["type"] == "circle":
            radius, large, left = bent["params"]
            new["curvature"] = {"type": "circle",
                                "params": [radius, bool(large), not left]}
        elif bent:
            place = [a + (b - a) * complex(*p) for p in bent["params"]]
            new["curvature"] = {"type": bent["type"], "params":
                                [[p.real, p.imag] for p in place[::-1]]}
        other["edges"].append(new)
    random.Random(1).shuffle(other["edges"])
    return other


def check_random(drape, work):
    """Panels at random, by their definition; then the same, told otherwise."""
    panels = {f"panel {k}": random_panel(k) for k in range(24)}
    path, out = os.path.join(work, "random.json"), os.path.join(work, "random")
    write(path, panels)
    tables, _ = run(drape, path, out, 0.004)
    for k, (name, row) in enumerate(zip(panels, tables["panels"])):
        panel = panels[name]
        file = os.path.join(out, f"{k:02}_panel_{k}.ply")
        assert row["panel"] == name and float(row["outline_cells"]) < 0.7, row
        look(file, outline(panel, UNIT), 0.004, row, 0.0)
    for row in tables["edges"]:
        panel = panels[row["panel"]]
        line = points(panel, panel["edges"][int(row["edge"])], UNIT, 4000)
        length = sum(abs(b - a) for a, b in zip(line, line[1:]))
        assert abs(length - float(row["length_m"])) < 1e-6 * length, row
    write(path, {name: reverse(panel) for name, panel in panels.items()},
          curvature_coords="absolute")
    again, _ = run(drape, path, os.path.join(work, "again"), 0.004)
    for a, b in zip(tables["panels"], again["panels"]):
        assert all(a[key] == b[key] for key in ("m", "n", "regular", "triangles",
                                                "particles", "border")), (a, b)
        assert abs(float(a["area_m2"]) - float(b["area_m2"])) < 1e-9


def at_length(line, part):
    """The point of a polyline at a part of its length."""
    steps = [abs(b - a) for a, b in zip(line, line[1:])]
    left = part * sum(steps)
    for k, step in enumerate(steps):
        if left <= step or k == len(steps) - 1:
            return line[k] + (line[k + 1] - line[k]) * left / step
        left -= step
    raise AssertionError


def look_at_seams(pattern, tables, cell, unit):
    """Each point of each seam: what it joins must be, within a cell and a half, at
    the same part of both edges' lengths, one of which runs against the other."""
    names, panels = [row["panel"] for row in tables["panels"]], pattern["panels"]
    ring = {name: outline(panel, unit) for name, panel in panels.items()}
    corner = {name: complex(min(p.real for p in line), min(p.imag for p in line))
              for name, line in ring.items()}

    def grid(name, p):
        m = int(tables["panels"][names.index(name)]["m"])
        return corner[name] + cell * complex(p % m, p // m)

    counts = [0] * len(pattern["stitches"])
    for row in tables["points"]:
        k = int(row["seam"])
        stitch = pattern["stitches"][k]
        mine = names[int(row["panel"])], int(row["edge"])
        onto = names[int(row["onto_panel"])], int(row["onto_edge"])
        sides = [(side["panel"], side["edge"]) for side in stitch[:2]]
        assert sorted([mine, onto]) == sorted(sides), row
        # how far along the first edge, as the file has it, and along the second
        first = float(row["at"])
        first = first if area(ring[sides[0][0]]) > 0 else 1 - first
        far = dict(zip(sides, (first, first if stitch[2:] == ["right_wrong"]
                               else 1 - first)))
        want = [at_length(points(panels[name], panels[name]["edges"][edge], unit),
                          far[name, edge]) for name, edge in (mine, onto)]
        part = float(row["part"])
        a, b = (grid(onto[0], int(row[key])) for key in ("onto_a", "onto_b"))
        got = grid(mine[0], int(row["particle"])), (1 - part) * a + part * b
        assert 0 <= part <= 1 and abs(a - b) < 2.9 * cell, row
        assert all(abs(p - q) < 1.5 * cell for p, q in zip(got, want)), (row, got, want)
        counts[k] += 1
    for k, row in enumerate(tables["seams"]):
        lengths = [float(row["length_a_m"]), float(row["length_b_m"])]
        assert counts[k] == int(row["points"])
        assert counts[k] > 0.6 * max(lengths) / cell - 2, row


def check_seams(drape, work):
    """Seams of random edges: of two panels, which may be drawn clockwise, of one
    panel, of edges that meet, and those that join a right to a wrong side."""
    dice = random.Random(5)
    panels, stitches = {}, []
    for k in range(16):
        panel = random_panel(100 + k)
        if k % 3 == 1:  # a mirror image
            panel["vertices"] = [[-x, y] for x, y in panel["vertices"]]
            for edge in panel["edges"]:
                bent = edge.get("curvature")
                if isinstance(bent, list):
                    bent[1] *= -1
                elif bent and bent["type"] == "circle":
                    bent["params"][2] = 1 - bent["params"][2]
                elif bent:
                    bent["params"] = [[x, -y] for x, y in bent["params"]]
        panels[f"panel {k}"] = panel
    free = [(name, edge) for name, panel in panels.items()
            for edge in range(len(panel["edges"]))]
    dart = [("panel 0", 0), ("panel 0", 1)]
    free = [side for side in free if side not in dart]
    dice.shuffle(free)
    free = dart + free
    for a, b in zip(free[::2], free[1::2]):
        stitches.append([{"panel": name, "edge": edge} for name, edge in (a, b)])
        if dice.random() < 0.4:
            stitches[-1].append("right_wrong")
    path = os.path.join(work, "seams.json")
    write(path, panels, stitches)
    tables, _ = run(drape, path, os.path.join(work, "seams"), 0.004)
    assert any(row["dart"] == "1" for row in tables["seams"])
    look_at_seams({"panels": panels, "stitches": stitches}, tables, 0.004, UNIT)


def check_eased(drape, work):
    """Two squares of whole cells, 10 and 7 cells wide: every place is exact."""
    panels = {}
    for name, side in (("wide", 10), ("narrow", 7)):
        at = [[0, 0], [side, 0], [side, 20], [0, 20]]
        panels[name] = {"vertices": at, "edges": [{"endpoints": [k, (k + 1) % 4]}
                                                  for k in range(4)]}
    panels["narrow"]["translation"] = [0, 0, 30]
    path = os.path.join(work, "eased.json")
    write(path, panels, [[{"panel": "narrow", "edge": 0}, {"panel": "wide", "edge": 2}]])
    tables, _ = run(drape, path, os.path.join(work, "eased"), 0.01)
    assert len(tables["points"]) == 11
    for k, row in enumerate(tables["points"]):
        part = float(row["part"])
        place = (1 - part) * int(row["onto_a"]) + part * int(row["onto_b"])
        # along the lower edge of one, against the upper one of the other
        assert abs(place - 0.7 * k) < 1e-9 and int(row["particle"]) == 220 + k, row
        length = 0.01 if 0 < k < 10 else 0.005
        assert abs(float(row["length_m"]) - length) < 1e-9, row
    gap = float(tables["seams"][0]["gap_m"])
    assert abs(gap - math.hypot(0.03, 0.2, 0.3)) < 1e-9, gap


def random_darts(seed):
    """A rectangle with a dart in each side, as narrow as a third of its depth or
    less, with its tip anywhere."""
    dice = random.Random(seed)
    side, at = 20 + 10 * dice.random(), []
    for k in range(4):
        turn = 1j ** k
        width = 0.4 + 2 * dice.random()
        depth = max(3 * width, 9 * dice.random())
        foot = side * (0.4 + 0.2 * dice.random())
        for along, in_by in ((0, 0), (foot, 0),
                             (foot + width * dice.random(), depth), (foot + width, 0)):
            at.append((along - side / 2 + 1j * (in_by - side / 2)) * turn)
    n = len(at)
    return {"vertices": [[p.real, p.imag] for p in at],
            "edges": [{"endpoints": [k, (k + 1) % n]} for k in range(n)],
            "translation": [0, 0, 0], "rotation": [0, 0, 0]}


def check_darts(drape, work):
    """The cells of both sides of a dart do not lie over each other."""
    panels = {f"darts {k}": random_darts(k) for k in range(30)}
    path, out = os.path.join(work, "darts.json"), os.path.join(work, "darts")
    write(path, panels)
    for cell in (0.004, 0.01):
        run(drape, path, out, cell)
        for k in range(len(panels)):
            file = os.path.join(out, f"{k:02}_darts_{k}.ply")
            done = subprocess.run([drape, "audit", file], capture_output=True, text=True,
                                  check=False)
            assert done.returncode == 0, (cell, done.stdout, done.stderr)


def check_sharp(drape, work):
    """Where no cell reaches a sharp corner, no two particles are held to one place."""
    panels, stitches = {}, []
    for k in range(8):
        high = 1.5 + 0.4 * k  # to a length of 20
        at = {f"wedge {k}": [[0, 0], [20, 0], [20, high]],
              f"whole {k}": [[0, 0], [20, 0], [20, 15], [0, 15]]}
        for name, ring in at.items():
            panels[name] = {"vertices": ring, "translation": [0, 0, 30],
                            "edges": [{"endpoints": [i, (i + 1) % len(ring)]}
                                      for i in range(len(ring))]}
        stitches.append([{"panel": name, "edge": 0} for name in at])
    path = os.path.join(work, "sharp.json")
    write(path, panels, stitches)
    tables, _ = run(drape, path, os.path.join(work, "sharp"), 0.01)
    ends = [(row["seam"], row["onto_a"]) for row in tables["points"]
            if row["onto_a"] == row["onto_b"]]
    assert len(set(ends)) == len(ends), ends


def check_arcs(drape, work):
    """The four arcs of one radius: above or below a chord of 10, small or large."""
    for large in (0, 1):
        for left in (0, 1):
            at = [[0, 0], [10, 0], [20, 0], [20, -30], [-10, -30], [-10, 0]]
            panel = {"vertices": at, "edges": [{"endpoints": [k, (k + 1) % 6]}
                                               for k in range(6)]}
            panel["edges"][0]["curvature"] = {"type": "circle",
                                              "params": [6, large, left]}
            path = os.path.join(work, "arc.json")
            write(path, {"arc": panel})
            tables, _ = run(drape, path, os.path.join(work, "arc"), 0.002)
            half = math.asin(5 / 6)
            part = 36 * half - 5 * math.sqrt(11)  # between the small arc and its chord
            part = 36 * math.pi - part if large else part
            # counter-clockwise along the upper side is downwards
            want = 900 - part if left else 900 + part
            got = float(tables["panels"][0]["area_m2"]) * 1e4
            assert abs(got - want) < 1e-6 * want, (large, left, got, want)


def check_square(drape, work):
    """A square of whole cells is a grid without an odd cell, in its place."""
    square = {"vertices": [[3, 4], [13, 4], [13, 24], [3, 24]], "label": "a, \"b\"", "unknown": {"label": 3},
              "edges": [{"endpoints": [k, (k + 1) % 4], "label": "", "curvature": None}
                        for k in range(4)],
              "translation": [10, 20, 30], "rotation": [90, 0, 90]}
    path, out = os.path.join(work, "square.json"), os.path.join(work, "square")
    write(path, {"a/../b": square})
    tables, _ = run(drape, path, out, 0.01)
    row = tables["panels"][0]
    assert (row["m"], row["n"], row["regular"], row["moved"], row["triangles"]) == (
        "11", "21", "200", "0", "0"), row
    assert row["label"] == 'a, "b"'
    # a quarter turn about x takes y to z; another about z takes x to y
    corner = (10 - 0.0, 20 + 3, 30 + 4)
    x, _ = load(os.path.join(out, "placed.ply"), "d")
    assert max(abs(100 * a - b) for a, b in zip(x[0], corner)) < 1e-9, x[0]
    x, _ = load(os.path.join(out, "00_a____b.ply"), "d")
    assert max(abs(a - b) for a, b in zip(x[0], (0.03, 0.04, 0))) < 1e-12, x[0]
    assert sorted(os.listdir(out)) == ["00_a____b.ply", "edges.csv", "panels.csv",
                                       "pattern.svg", "placed.ply", "points.csv", "seams.csv"]


def check_file(drape, path, work):
    """A garment by its file, at 5 and 2 mm: the bars of area and outline."""
    with open(path, encoding="utf-8") as file:
        pattern = json.load(file)
    panels = pattern["pattern"]["panels"]
    unit = pattern["properties"]["units_in_meter"]
    for cell in (0.005, 0.002):
        out = os.path.join(work, f"{os.path.basename(path)}-{cell}")
        tables, _ = run(drape, path, out, cell)
        assert len(tables["panels"]) == len(panels)
        assert len(tables["seams"]) == len(pattern["pattern"]["stitches"])
        look_at_seams(pattern["pattern"], tables, cell, unit)
        for k, row in enumerate(tables["panels"]):
            assert abs(float(row["area_error"])) < 1e-3, row
            assert float(row["outline_cells"]) < 0.7, row
            if cell == 0.005:
                name = "".join(c if c.isalnum() and c.isascii() or c in "-" else "_"
                               for c in row["panel"])
                look(os.path.join(out, f"{k:02}_{name}.ply"),
                     outline(panels[row["panel"]], unit), cell, row,
                     float(row["darts_cells"]))


def main(drape, *paths):
    random.seed(1)
    with tempfile.TemporaryDirectory() as work:
        if paths:
            for path in paths:
                check_file(drape, path, work)
            return
        check_square(drape, work)
        check_darts(drape, work)
        check_sharp(drape, work)
        check_arcs(drape, work)
        check_random(drape, work)
        check_seams(drape, work)
        check_eased(drape, work)


if __name__ == "__main__":
    main(*sys.argv[1:])
