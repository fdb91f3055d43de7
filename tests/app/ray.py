# SPDX-License-Identifier: Apache-2.0
"""Draws a small picture of a run's frame anew, in binary64 and by a search of
all triangles, and compares the tool's with it.

usage: ray.py write FILE CAMERA FLOOR    a scene; FLOOR: its level obstacle
       ray.py check DIR FRAME PNG SAMPLES    its picture of 20 × 16 pixels
Fails with the number of pixels that differ.
"""
import json
import math
import sys

from geometry import cross, dot, load, minus, unit
from png import read

WIDTH, HEIGHT = 20, 16
# Bytes are rounded; a sample beside an edge may fall on either side of it.
NEAR, STRAY = 1.5, 1


def write(path):
    camera = json.loads(sys.argv[3])
    # where the tool chooses the camera the scene is far from the origin
    far = [0, 0, 0] if "eye" in camera["camera"] else [3, 2.5, -4]

    def sheet(at, **more):
        return {"particles": [9, 8], "size": [0.8, 0.7],
                "start": {"at": add(at, far), "u": [1, 0.3, 0.1]}, **more}

    def small(k):
        return {"particles": [3, 4], "size": [0.2, 0.3], "look": {"gloss": 0},
                "start": {"at": add([0.6 * k - 0.3, 0.1, 0.9 + 0.1 * k], far)}}
    with open("floor.off", "w") as file:
        file.write("OFF 4 2\n-2 0 -2\n2 0 -2\n2 0 2\n-2 0 2\n3 0 1 2\n3 0 2 3\n")
    with open(path, "w") as file:
        json.dump({"frames": 1, "dt": 1 / 60, "gravity": [0, 0, 0],
                   "cloths": [
                       sheet([-0.6, 0.7, 0], cuts=[{"disc": [0.4, 0.35, 0.17]}]),
                       sheet([0.7, 0.5, 0.2], cuts=[
                           {"disc": [0.4, 0.35, 0.12]},
                           {"rect": [0, 0.2, 0.1, 0.4]},
                           {"rect": [0.7, 0.4, 0.8, 0.6]},
                           {"rect": [0.5, 0, 0.6, 0.1]},
                           {"rect": [0.1, 0.6, 0.3, 0.7]}], look={
                           "colour": [0.9, 0.7, 0.1], "inside": [0.1, 0.5, 0.9],
                           "gloss": 1, "check": False}),
                       *(small(k) for k in range(3))],
                   "obstacles": [
                       {"shape": "sphere", "radius": 0.25, "detail": 8,
                        "at": add([0, 0.3, 0.6], far), "look": {"colour": [0.2, 0.8, 0.3]}},
                       {**json.loads(sys.argv[4]), "at": add([0, -0.2, 0], far)},
                       {"shape": "plane", "extent": [0.9, 1, 0.9],
                        "at": add([1, 0, 0.4], far)},
                       {"shape": "box", "extent": [0.3, 0.9, 0.3], "angle": 20,
                        "at": add([-0.9, 0.2, -0.6], far), "look": {"gloss": 0.5}}],
                   **camera}, file)


# Vectors

def add(*vectors):
    return [sum(parts) for parts in zip(*vectors)]


def scale(a, s):
    return [s * v for v in a]


def mul(a, b):
    return [p * q for p, q in zip(a, b)]


def clamp(a):
    return min(max(a, 0), 1)


def mix(a, b, t):
    return add(scale(a, 1 - t), scale(b, t))


# What there is to see

def linear(part):
    return part / 12.92 if part < 0.04045 else ((part + 0.055) / 1.055) ** 2.4


DYES = [[[.42, .018, .028], [.60, .36, .13]], [[.020, .12, .34], [.55, .56, .60]],
        [[.45, .26, .030], [.34, .05, .10]], [[.020, .24, .13], [.62, .58, .42]]]
STONE = [.60, .555, .49]


class Surface:
    """How one body looks: its two sides, and grid numbers of a cloth."""

    def __init__(self, body, number):
        look = body["look"]
        self.cloth = "particles" in body
        dye = DYES[number % 4] if self.cloth else [STONE, STONE]
        inside = look.get("inside") or (not self.cloth and look.get("colour"))
        self.side = [[linear(v) for v in look["colour"]]
                     if "colour" in look else dye[0],
                     [linear(v) for v in inside] if inside else dye[1]]
        self.gloss = 0.1 * look["gloss"] if "gloss" in look else \
            0.007 if self.cloth else 0.05
        self.sheen = 0.35 if self.cloth else 0
        self.check = self.cloth and look["check"]


def rounded(x, tri, m, n):
    """A cloth's vertices; those of the rims of its holes go three times by a half
    to the middle of their neighbours there."""
    edges = [(a, b) for t in tri for a, b in zip(t, t[1:] + t[:1])]
    known, beside = set(edges), {}
    for a, b in edges:
        if (b, a) not in known:
            beside.setdefault(a, []).append(b)
            beside.setdefault(b, []).append(a)
    for _ in range(3):
        old = list(x)
        for p, two in beside.items():
            if 0 < p % m < m - 1 and 0 < p // m < n - 1 and len(two) == 2:
                x[p] = mix(old[p], scale(add(old[two[0]], old[two[1]]), .5), .5)
    return x


def area(x, t):
    a, b, c = (x[v] for v in t)
    return math.hypot(*cross(minus(b, a), minus(c, a))) / 2


class Model:
    def __init__(self, run, frame, report):
        self.tri, self.floor = [], None
        cloths = [b for b in report["bodies"] if b["kind"] == "cloth"]
        stones = [b for b in report["bodies"] if b["kind"] == "obstacle"]
        self.take(load("%s/frames/cloth_%04d.ply" % (run, frame)), cloths, 0)
        self.take(load(run + "/obstacles.ply"), stones, len(cloths))

    def take(self, mesh, parts, number):
        x, tri = mesh
        at = [(b["first_vertex"] - parts[0]["first_vertex"],
               b["first_triangle"] - parts[0]["first_triangle"])
              for b in parts] + [(len(x), len(tri))]
        for k, body in enumerate(parts):
            (v, t), (w, u) = at[k], at[k + 1]
            own = [[p - v for p in f] for f in tri[t:u]]
            self.add(x[v:w], own, body, Surface(body, number + k))

    def add(self, x, tri, body, surface):
        uv = [(0, 0)] * len(x)
        if surface.cloth:
            (m, n), (width, height) = body["particles"], body["size"]
            uv = [(width * (k % m) / (m - 1), height * (k // m) / (n - 1))
                  for k in range(m * n)]
            x = rounded(x, tri, m, n)
        elif len({p[1] for p in x}) == 1 and area(x, tri[0]) > 1:
            self.floor = x[0][1]
            return
        normal = [[0, 0, 0] for _ in x]
        for t in tri:
            a, b, c = (x[v] for v in t)
            flat = cross(minus(b, a), minus(c, a))
            for v in t:
                normal[v] = add(normal[v], flat)
        for t in tri:
            a, b, c = (x[v] for v in t)
            self.tri.append((a, minus(b, a), minus(c, a), [unit(normal[v])
                             for v in t], [uv[v] for v in t], surface))

    def box(self):
        corners = [p for a, u, v, *_ in self.tri
                   for p in (a, add(a, u), add(a, v))]
        return ([min(p[i] for p in corners) for i in range(3)],
                [max(p[i] for p in corners) for i in range(3)])

    def first(self, p, d):
        """The nearest triangle of a ray: distance, triangle and weights."""
        best = math.inf, None, None
        for t in self.tri:
            a, u, v = t[:3]
            h = cross(d, v)
            det = dot(u, h)
            if abs(det) < 1e-14:
                continue
            s = minus(p, a)
            b = dot(s, h) / det
            if b < 0 or b > 1:
                continue
            q = cross(s, u)
            c, far = dot(d, q) / det, dot(v, q) / det
            if c >= 0 and b + c <= 1 and 1e-5 < far < best[0]:
                best = far, t, (1 - b - c, b, c)
        return best


# Light

def sky(d):
    return mix([0.40, 0.41, 0.43], [0.42, 0.50, 0.64], clamp(d[1]))


def weave(u, v):
    a, b = 25 * u, 25 * v
    even = (math.floor(a) + math.floor(b)) % 2 == 0
    thread = min(a - math.floor(a), b - math.floor(b)) < 0.06
    return (0.9 if even else 1) * (0.82 if thread else 1)


def scramble(a):
    a = (a ^ a >> 16) * 0x7feb352d & 0xffffffff
    a = (a ^ a >> 15) * 0x846ca68b & 0xffffffff
    return a ^ a >> 16


STEP = [0.8986538526, 0.8075787467, 0.7257337563, 0.6521834357, 0.5860871504,
        0.5266894846]
FLOOR_STEP = [0.8566749, 0.7338919, 0.6287067, 0.5385973]


def randoms(pixel, sample):
    return [(scramble(pixel * 6 + j) / 2 ** 32 + (sample + 1) * STEP[j]) % 1 *
            0.999999 for j in range(6)]


def about(n, a, b, spread):
    side = [0, 1, 0] if abs(n[0]) > 0.5 else [1, 0, 0]
    t = unit(cross(n, side))
    u = cross(n, t)
    r, angle = math.sqrt(a) * spread, 2 * math.pi * b
    return add(scale(t, r * math.cos(angle)), scale(u, r * math.sin(angle)),
               scale(n, math.sqrt(1 - r * r)))


class Hit:
    """What a ray meets first; floor: whether it is the endless floor."""

    def __init__(self, studio, p, d):
        far, t, w = studio.model.first(p, d)
        floor = studio.model.floor
        down = -1 if floor is None else (floor - p[1]) / d[1]
        self.floor = d[1] < 0 and 0 < down < far
        self.none = not self.floor and t is None
        self.distance = down if self.floor else far
        if self.none:
            return
        self.at = add(p, scale(d, self.distance))
        if self.floor:
            self.face = self.normal = [0, 1, 0]
            self.colour, self.gloss, self.sheen = studio.floor, 0, 0
            return
        face = unit(cross(t[1], t[2]))
        outside = dot(face, d) > 0
        self.face = scale(face, -1) if outside else face
        normal = unit(add(*(scale(n, v) for n, v in zip(t[3], w))))
        self.normal = normal if dot(normal, self.face) >= 0 else \
            scale(normal, -1)
        surface = t[5]
        uv = [sum(v * c[k] for v, c in zip(w, t[4])) for k in range(2)]
        self.colour = scale(surface.side[0 if outside else 1],
                            weave(*uv) if surface.check else 1)
        self.gloss, self.sheen = surface.gloss, surface.sheen


class Studio:
    def __init__(self, run, frame):
        with open(run + "/report.json") as file:
            report = json.load(file)
        self.model = Model(run, frame, report)
        picture = report["picture"]
        eye, target = self.camera(report)
        turn = math.radians(picture["turn"] * frame / 60)
        x, z = eye[0] - target[0], eye[2] - target[2]
        self.eye = [target[0] + math.cos(turn) * x + math.sin(turn) * z, eye[1],
                    target[2] - math.sin(turn) * x + math.cos(turn) * z]
        self.ahead = unit(minus(target, self.eye))
        self.far = 4 * math.dist(target, self.eye)
        edge = math.tan(math.radians(picture["fov"]) / 2)
        right = unit(cross(self.ahead, [0, 1, 0]))
        self.up = scale(cross(right, self.ahead), edge)
        self.right = scale(right, edge * WIDTH / HEIGHT)
        self.light = scale([1.75, 1.62, 1.42], picture["light"])
        self.floor = [linear(v) for v in picture["floor"]]
        self.sun = unit(picture["sun"] if any(picture["sun"]) else add(
            scale(self.ahead, -0.55), scale(right, -0.75), [0, 1, 0]))

    def camera(self, report):
        if "camera" in report:
            return report["camera"]["eye"], report["camera"]["target"]
        lo, hi = self.model.box()
        target = scale(add(lo, hi), 0.5)
        reach = max(minus(hi, lo))
        return add(target, scale([1.25, 0.85, 1.75], reach)), target

    def shade(self, h, view, random):
        at, light = add(h.at, scale(h.face, 2e-4)), [0, 0, 0]
        sun = about(self.sun, *random[:2], 0.10)
        lit = dot(h.normal, sun)
        if lit > 0 and dot(h.face, sun) > 0 and not self.model.first(at, sun)[1]:
            half = unit(add(sun, view))
            shine = clamp(dot(h.normal, half)) ** 40 * h.gloss * 12
            light = mul(add(scale(h.colour, lit), [shine] * 3), self.light)
        d = about(h.normal, *random[2:], 0.9999)
        other = Hit(self, at, d)
        bounce = sky(d) if other.none else scale(other.colour,
                                                 0.75 if other.floor else 0.40)
        sheen = h.sheen * (1 - clamp(dot(h.normal, view))) ** 3
        return add(light, scale(mul(h.colour, bounce), 0.85), scale(
            mul(bounce, mix(h.colour, [1, 1, 1], 0.3)), sheen))

    def trace(self, d, random):
        hit, backdrop = Hit(self, self.eye, d), sky([0, 0, 0])
        if hit.none:
            return mix(backdrop, sky(d), clamp(d[1]))
        view = scale(d, -1)
        if not hit.floor:
            return self.shade(hit, view, random)
        light = [0, 0, 0]
        for k in range(3):
            r = [(v + k * step) % 1 * 0.999999
                 for v, step in zip(random, FLOOR_STEP)]
            light = add(light, scale(self.shade(hit, view, r), 1 / 3))
        t = clamp(hit.distance / self.far)
        return mix(light, backdrop, t * t * (3 - 2 * t))

    def pixel(self, row, column, samples):
        light = [0, 0, 0]
        for k in range(samples):
            r = randoms(row * WIDTH + column, k)
            x = 2 * (column + r[0]) / WIDTH - 1
            y = 1 - 2 * (row + r[1]) / HEIGHT
            d = unit(add(self.ahead, scale(self.right, x), scale(self.up, y)))
            light = add(light, scale(self.trace(d, r[2:]), 1 / samples))
        return [develop(v) for v in light]


def develop(light):
    a = 0.78 * light
    a = clamp(a * (2.51 * a + 0.03) / (a * (2.43 * a + 0.59) + 0.14))
    return 255 * (12.92 * a if a < 0.0031308 else 1.055 * a ** (1 / 2.4) - 0.055)


def check_looks(run):
    """The report has the looks of the scene, and what they leave out."""
    with open(run + ".json") as file:
        scene = json.load(file)
    with open(run + "/report.json") as file:
        bodies = json.load(file)["bodies"]
    for body, told in zip(scene["cloths"] + scene["obstacles"], bodies):
        assert told["look"] == {"check": True, **body.get("look", {})}, told


def check(run, frame, png, samples):
    check_looks(run)
    studio, rows, wrong, kinds = Studio(run, int(frame)), read(png), [], set()
    assert len(rows) == HEIGHT and len(rows[0]) == 3 * WIDTH
    for row in range(HEIGHT):
        for column in range(WIDTH):
            here = studio.pixel(row, column, int(samples))
            there = rows[row][3 * column:3 * column + 3]
            kinds.add(tuple(there))
            if math.dist(here, there) > NEAR:
                wrong.append((row, column, here, list(there)))
    assert len(kinds) > 40, "pixels are alike"
    assert len(wrong) <= STRAY, "%d pixels, as %s" % (len(wrong), wrong[:3])


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(sys.argv[2])
    else:
        check(*sys.argv[2:])
