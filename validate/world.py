# SPDX-License-Identifier: Apache-2.0
"""Scenes that are measured: the library's own structs, as they tell of each particle
whether it is pinned or a hole, which a scene's file does not. Numbers are formed in one
order on every machine, for the sums in their order `total` and `dot`.
spec/validation.md §1, §13"""
import math
import sys

import numpy as np
from drape._core import ffi, lib
from drape.contacts import ROW

G = 9.81
NAN = math.nan
NOTHING = ffi.NULL


def doubles(array):
    return NOTHING if array is None else ffi.cast("double (*)[3]", array.ctypes.data)


def total(rows):
    """The sum of rows, one after the other; NumPy's own groups them."""
    return np.cumsum(rows, axis=0)[-1] if len(rows) else np.zeros(np.shape(rows)[1:])


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a, b):
    return np.stack([a[..., (c + 1) % 3] * b[..., (c + 2) % 3] -
                     a[..., (c + 2) % 3] * b[..., (c + 1) % 3] for c in range(3)], -1)


def distance(a, b):
    return np.hypot(np.hypot(a[..., 0] - b[..., 0], a[..., 1] - b[..., 1]),
                    a[..., 2] - b[..., 2])


def around(number):
    """The whole number nearest to a positive one."""
    return int(number + 0.5)


class Cloth:
    """m × n particles in square cells of side h, all at one place; with the library's
    defaults. pins: (i, j, number of a motion, or -1). x, v: None leaves them to the
    library."""

    def __init__(self, m, n, h):
        self.struct = ffi.new("drape_cloth *")
        lib.drape_default_cloth(self.struct)
        self.m, self.n, self.count = m, n, m * n
        self.struct.m, self.struct.n = m, n
        self.struct.width, self.struct.height = (m - 1) * h, (n - 1) * h
        self.i, self.j = np.arange(m * n) % m, np.arange(m * n) // m
        self.x, self.v = np.zeros((m * n, 3)), np.zeros((m * n, 3))
        self.hole = np.zeros(m * n, np.uint8)
        self.pins = []

    @property
    def material(self):
        return self.struct.material

    @material.setter
    def material(self, numbers):
        self.struct.material = numbers

    def pin(self, i, j, motion=-1):
        self.pins.append((i, j, motion))

    @property
    def mass(self):
        """What it weighs, kg."""
        return self.material.density * self.struct.width * self.struct.height

    @property
    def thickness(self):
        """The one that counts in contact: at most half a cell."""
        return min(self.material.thickness, self.struct.width / (self.m - 1) / 2)

    def mean(self, of):
        """The mean by mass of positions, or velocities."""
        part = (np.where((self.i == 0) | (self.i == self.m - 1), 0.5, 1) *
                np.where((self.j == 0) | (self.j == self.n - 1), 0.5, 1))
        return total((part / ((self.m - 1.0) * (self.n - 1)))[:, None] * of)

    def cells(self):
        """The first particles of the cells that have no hole."""
        p = np.flatnonzero((self.i + 1 < self.m) & (self.j + 1 < self.n))
        holes = sum(self.hole[p + q] for q in (0, 1, self.m, self.m + 1))
        return p[holes == 0]


class Scene:
    """What a world is made of. settings: the drape_def, without sleep; material: that
    of sheets to be added."""

    def __init__(self, v, how=None, dt=1 / 60):
        self.settings = ffi.new("drape_def *")
        lib.drape_default(self.settings)
        self.settings.backend = v.backend
        self.settings.precision = v.bits
        self.settings.sleep = 0
        self.settings.dt = dt
        if how:
            self.settings.integrator, self.settings.newton = how.integrator, how.newton
        cloth = ffi.new("drape_cloth *")
        lib.drape_default_cloth(cloth)
        self.kept = [cloth]
        self.material = cloth.material
        self.cloths, self.bodies, self.motions = [], [], []

    def sheet(self, m, n, h, at=(0, 0, 0)):
        """Adds a level sheet whose corner is at `at`, i along x and j along z."""
        cloth = Cloth(m, n, h)
        cloth.material = self.material
        cloth.x[:, 0] = at[0] + h * cloth.i
        cloth.x[:, 1] = at[1]
        cloth.x[:, 2] = at[2] + h * cloth.j
        cloth.number = len(self.cloths)
        self.cloths.append(cloth)
        return cloth

    def body(self, x, triangles, friction=None, motion=-1):
        """Adds an obstacle; friction None: the library's default."""
        body = ffi.new("drape_obstacle *")
        lib.drape_default_obstacle(body)
        x = np.array(x, float)
        triangles = np.array(triangles, np.int32)
        self.kept += [x, triangles]
        body.n_vertices, body.n_triangles = len(x), len(triangles)
        body.x = doubles(x)
        body.tri = ffi.cast("int32_t (*)[3]", triangles.ctypes.data)
        if friction is not None:
            body.friction = friction
        body.motion = motion
        self.bodies.append(body)
        return body

    def floor(self, friction):
        """Adds a level square of 12 m in two triangles at height 0."""
        self.body([(-6, 0, -6), (6, 0, -6), (6, 0, 6), (-6, 0, 6)],
                  [(0, 2, 1), (0, 3, 2)], friction)

    def motion(self, start, end, ramp, velocity):
        """Adds a motion that goes by 0 until `start`, then at this velocity until
        `end`, after it has sped up for `ramp`. Returns its number."""
        parts = [k / 30 for k in range(31)] if ramp > 0 else [0.0]
        times = [start + part * ramp for part in parts]
        ways = [[one * part * part * ramp / 2 for one in velocity] for part in parts]
        return self.keys([*times, end],
                         [*ways, [one * (end - start - ramp / 2) for one in velocity]])

    def keys(self, times, ways, rotations=None, pivot=(0, 0, 0)):
        """Adds a motion by keyframes; rotations are quaternions. Returns its number."""
        motion = ffi.new("drape_motion *", {"pivot": pivot})
        times, ways = np.array(times, float), np.array(ways, float)
        self.kept += [times, ways]
        motion.keys = len(times)
        motion.time = ffi.cast("double *", times.ctypes.data)
        motion.position = doubles(ways)
        if rotations:
            rotations = np.array(rotations, float)
            self.kept.append(rotations)
            motion.rotation = ffi.cast("double (*)[4]", rotations.ctypes.data)
        self.motions.append(motion)
        return len(self.motions) - 1

    def fill(self):
        """Gives the settings all that. Returns what must be kept as long as they are."""
        settings = self.settings
        cloths = ffi.new("drape_cloth[]", max(1, len(self.cloths)))
        bodies = ffi.new("drape_obstacle[]", [body[0] for body in self.bodies])
        motions = ffi.new("drape_motion[]", [each[0] for each in self.motions])
        kept = [cloths, bodies, motions]
        for k, cloth in enumerate(self.cloths):
            cloths[k] = cloth.struct[0]
            pins = ffi.new("drape_pin[]", cloth.pins)
            kept.append(pins)
            cloths[k].x, cloths[k].velocity = doubles(cloth.x), doubles(cloth.v)
            cloths[k].pins, cloths[k].n_pins = pins, len(cloth.pins)
            if cloth.hole.any():
                cloths[k].hole = ffi.cast("uint8_t *", cloth.hole.ctypes.data)
        settings.cloths, settings.n_cloths = cloths, len(self.cloths)
        settings.obstacles, settings.n_obstacles = bodies, len(self.bodies)
        settings.motions, settings.n_motions = motions, len(self.motions)
        return kept

    def create(self):
        """A world of all that, or None; and why it was refused, else nothing."""
        kept = self.fill()
        made, error = ffi.new("drape_world **"), ffi.new("drape_error *")
        status = lib.drape_create(self.settings, made, error)
        del kept
        if status != 0:
            return None, ffi.string(error.text).decode()
        return World(ffi.gc(made[0], lib.drape_destroy), self.settings.dt), ""

    def world(self):
        """A world of all that; None after a line on standard error."""
        made, text = self.create()
        if text:
            print("validate:", text, file=sys.stderr)
        return made


class World:
    """A world and its last state. x, u: of all vertices, after `read`; steps,
    iterations: since its start."""

    def __init__(self, made, dt):
        self.made, self.dt = made, dt
        self.report = ffi.new("drape_step_report *")
        self.x = np.zeros((lib.drape_vertices(made), 3))
        self.u = np.zeros_like(self.x)
        self.steps = self.iterations = 0
        self.read()

    def read(self):
        lib.drape_read(self.made, doubles(self.x), doubles(self.u))

    def step(self):
        """Whether a step was made, which may have diverged."""
        good = lib.drape_step(self.made, self.report) == 0
        self.steps += good
        self.iterations += self.report.iterations if good else 0
        return good

    def goes(self):
        """Whether a step was made and did not diverge; reads the state."""
        if not self.step() or self.report.outcome & lib.DRAPE_DIVERGED:
            return False
        self.read()
        return True

    def until(self, time):
        """Steps until this time since the start. False: one failed or diverged."""
        while self.steps + 0.5 < time / self.dt:
            if not self.goes():
                return False
        return True

    def mean(self, cloth, of):
        """The mean by mass of the positions or velocities of a cloth."""
        first = lib.drape_first_vertex(self.made, cloth.number)
        return cloth.mean(of[first:first + cloth.count])

    def contacts(self):
        """The pairs of the last step, what each body got, N·s, and the slice's length;
        None: there is no list."""
        c = ffi.new("drape_contact_list *")
        if lib.drape_contacts(self.made, c) != 0:
            return None
        bytes_of = ffi.buffer(c.contact, c.n * ROW.itemsize) if c.n else b""
        return np.frombuffer(bytes_of, ROW), c.impulse, c.dt

    def steepest(self, before):
        """The largest quotient of friction and normal force of a contact in the last
        step, where the normal force is not mere rounding; `before` at least."""
        found = self.contacts()
        if found is None:
            return NAN
        impulse = found[0]["impulse"]
        along = dot(impulse, found[0]["normal"])
        square = dot(impulse, impulse)
        loaded = along > 1e-9 * total(np.abs(along))
        across = np.sqrt(np.fmax(0, square - along * along))[loaded]
        return float(np.fmax.reduce(across / along[loaded], initial=before))


def sheet(v, m, n, h):
    """A scene of one sheet, flat in the plane of x and y, j along -y; without
    collisions with itself and slices. Returns the sheet, whose `scene` it is."""
    scene = Scene(v)
    cloth = scene.sheet(m, n, h)
    cloth.x[:, 1] = -cloth.x[:, 2]
    cloth.x[:, 2] = 0
    scene.settings.self_collision = 0
    scene.settings.max_slices = 1
    scene.settings.tolerance = 1e-8 if v.bits == 64 else 1e-5
    cloth.scene = scene
    return cloth


def lay(cloth):
    """Turns a sheet to the plane of x and z: gravity then pulls across."""
    cloth.x[:, 2] = cloth.x[:, 1]
    cloth.x[:, 1] = 0


def world_of(cloth, dt):
    cloth.scene.settings.dt = dt
    return cloth.scene.world()


def energy_of(cloth):
    """The elastic energy of a sheet as it stands, J; NaN after a fault. Of one
    explicit step so short that nothing moves; the sheet is spent by it."""
    settings = cloth.scene.settings
    settings.gravity = [0, 0, 0]
    settings.integrator = lib.DRAPE_EULER
    world = world_of(cloth, 1e-9)
    return world.report.elastic if world and world.step() else NAN


def settle(cloth, dt, steps, still):
    """Up to `steps` steps of dt from where the sheet is at rest, to where it is then,
    until one moves nothing by more than `still`. Returns the last step's way, or NaN
    if a step failed or diverged."""
    world = world_of(cloth, dt)
    way = NAN
    for _ in range(steps if world else 0):
        if not world.goes():
            return NAN
        x = world.x[:cloth.count]
        moved = distance(cloth.x, x)
        way = NAN if np.isnan(moved).any() else moved.max()
        cloth.x[:] = x
        if world.report.outcome & lib.DRAPE_UNCONVERGED:
            way = math.inf  # it says nothing of how far rest is
        if way <= still:
            break
    return way


def rest_by(cloth, newton, shortest, still):
    """Seeks rest by steps that solve at least so many systems, as linear ones of such
    length go on as before (blocks.md §8)."""
    settings = cloth.scene.settings
    settings.integrator = lib.DRAPE_BW
    settings.newton = max(settings.newton, newton)
    cloth.v[:] = 0
    dt = shortest
    while dt < 1:  # each stage starts at rest, which takes the energy that is left
        settle(cloth, dt, 40, 1e2 * still)
        dt *= 3
    return settle(cloth, 1, 1000, still) <= still


def rest(cloth, still):
    """Moves a sheet to equilibrium: implicit steps that grow from 1/60 s, or from
    1/200 s where these find none, until one of 1 s, which is nearly a step of Newton's
    method, moves no particle by more than `still` m. False: not found, and x is the
    last state."""
    start = cloth.x.copy()
    if rest_by(cloth, 2, 1 / 60, still):
        return True
    cloth.x[:] = start  # a way that is followed more closely
    return rest_by(cloth, 8, 1 / 200, still)
