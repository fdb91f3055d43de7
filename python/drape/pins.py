# SPDX-License-Identifier: Apache-2.0
"""Particles by where they are, and groups of pins that are led one by one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import scene as scenes
from ._core import ffi
from .bodies import Body
from .control import Control
from .errors import SceneError

Ids = NDArray[np.int32]
Array = NDArray[np.float64]

EDGES = ("u0", "u1", "v0", "v1")
NEAR = 1e-3  # of a mesh's size: a body that is so far from rigid has no pose


class Pose(NamedTuple):
    """Where a rigid body is: its vertex X of the scene is at position + R X.

    Attributes:
        position: [3] m
        rotation: [4] quaternion w, x, y, z of R, of length 1
    """

    position: Array
    rotation: Array


def matrix(rotation: ArrayLike) -> Array:
    """Returns the matrix R [3, 3] of a quaternion w, x, y, z of length 1."""
    w, x, y, z = np.asarray(rotation, np.float64)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _quaternion(r: Array) -> Array:
    """Returns the quaternion w, x, y, z of a rotation's matrix: the eigenvector of
    the largest eigenvalue of a symmetric matrix (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = r
    k = np.array(
        [
            [a + e + i, h - f, c - g, d - b],
            [h - f, a - e - i, b + d, c + g],
            [c - g, b + d, e - a - i, f + h],
            [d - b, c + g, f + h, i - a - e],
        ]
    )
    q: Array = np.linalg.eigh(k)[1][:, -1]
    return q if q[0] >= 0 else -q


def rigid(before: Array, after: Array) -> tuple[Pose, float]:
    """Returns the pose that takes points to others with the least squares of what
    is left (Kabsch 1976), and the largest distance that is left, m."""
    a, b = before.mean(0), after.mean(0)
    u, _, v = np.linalg.svd((before - a).T @ (after - b))
    turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    left = np.linalg.norm((before - a) @ turn.T + b - after, axis=1).max()
    return Pose(b - turn @ a, _quaternion(turn)), float(left)


class Pins:
    """A group of particles of a cloth that are held together; `World.pin` makes one.

    Attributes:
        name: of the group
        cloth: the cloth's number among the cloths
        particles: [n] numbers i + m·j
        targets: [n, 3] m, where they are at the end of the next step
        follow: the number of the obstacle whose pose they follow; None: of none
    """

    def __init__(
        self, world: Pinning, name: str, cloth: int, particles: Ids, targets: Array
    ) -> None:
        """Made by a world."""
        self._world = world
        self.name, self.cloth, self.particles = name, cloth, particles
        self.targets = targets
        self.follow: int | None = None
        self._seat: Array | None = None  # [n, 3] m, beside the body's definition

    def __repr__(self) -> str:
        """The group in one line."""
        led = "" if self.follow is None else f", follows obstacle {self.follow}"
        count = len(self.particles)
        return f"<drape.Pins {self.name!r}: {count} of cloth {self.cloth}{led}>"

    def to(self, targets: ArrayLike) -> None:
        """Tells where the particles are at the end of the next step: [n, 3] m."""
        where = f"pins {self.name!r}: targets"
        self._lead(scenes.array(targets, (len(self.particles), 3), where))

    def move(self, by: ArrayLike) -> None:
        """Moves the targets of all particles by [3] m in the next step."""
        self._lead(self.targets + scenes.array(by, (3,), f"pins {self.name!r}: by"))

    def _lead(self, targets: Array) -> None:
        if self.follow is not None:
            raise SceneError(
                f"pins {self.name!r}: they follow an obstacle: move that by set_pose"
            )
        self._world._set_group(self, targets)

    def release(self) -> None:
        """Lets the particles go, with the velocity with which they were led."""
        self._world._drop_group(self)


class Pinning(Control):
    """What a `World` adds to live control: particles by where they are, and pins in
    groups. A group ends by `Pins.release`, by `set_pins` of its cloth, and when a
    checkpoint or a log is read, whose pins then hold."""

    _groups: dict[str, Pins]
    _told: set[int]
    _triangles: NDArray[np.int32]

    def _loaded(self) -> None:
        """Called when a checkpoint or a log was read: its pins hold."""
        self._groups.clear()
        self._told = set(range(len(self.bodies)))

    def read(self) -> tuple[Array, Array]:
        """Copies positions and velocities."""
        raise NotImplementedError

    def select(
        self,
        cloth: int | str | Body,
        *,
        edge: str | None = None,
        at: ArrayLike | None = None,
        disc: ArrayLike | None = None,
        rect: ArrayLike | None = None,
        near: ArrayLike | None = None,
        radius: float | None = None,
        box: ArrayLike | None = None,
    ) -> Ids:
        """Returns particles of a cloth by where they are: those that meet all that is
        given, ascending. Particles of holes are never among them.

        Args:
            cloth: its number, name or `Body`
            edge: "u0", "u1" (the first and last column), "v0" or "v1" (rows)
            at: [2] m at rest, the nearest particle
            disc: x, y, r and
            rect: x0, y0, x1, y1, m at rest from the corner u0 v0, as of holes
            near: [3] m, now: the nearest particle, or all within `radius`, m
            box: [2, 3] m, its lowest and its highest corner, now

        Returns:
            [n] numbers i + m·j, as `set_pins` and `pin` take them
        """
        _, body = self._one(cloth, "cloth")
        rest = body.rest
        start = body.vertices.start
        good = np.zeros(len(rest), bool)
        good[np.unique(self._triangles[body.triangles]) - start] = True
        (m, n), who = body.particles, np.arange(len(rest))
        if edge is not None:
            if edge not in EDGES:
                raise SceneError(f"edge: {edge!r}: expected one of {', '.join(EDGES)}")
            line = who % m if edge[0] == "u" else who // m
            good &= line == (0 if edge[1] == "0" else (m if edge[0] == "u" else n) - 1)
        if disc is not None:
            x, y, r = scenes.array(disc, (3,), "disc")
            good &= np.hypot(*(rest - [x, y]).T) <= r
        if rect is not None:
            corners = scenes.array(rect, (4,), "rect").reshape(2, 2)
            good &= ((rest >= corners[0]) & (rest <= corners[1])).all(1)
        if near is not None or box is not None:
            now = self.read()[0][body.vertices]
            if box is not None:
                low, high = scenes.array(box, (2, 3), "box")
                good &= ((now >= low) & (now <= high)).all(1)
            if near is not None:
                away = np.linalg.norm(now - scenes.array(near, (3,), "near"), axis=1)
                good &= away <= radius if radius is not None else _least(away, good)
        elif radius is not None:
            raise SceneError("radius: it is of near, which is not given")
        if at is not None:
            away = np.linalg.norm(rest - scenes.array(at, (2,), "at"), axis=1)
            good &= _least(away, good)
        return np.flatnonzero(good).astype(np.int32)

    def pose(self, obstacle: int | str | Body) -> Pose:
        """Returns the pose that an obstacle has now, which `set_pose` takes. A
        SceneError where it deforms."""
        k, body = self._one(obstacle, "obstacle")
        rest = self._open().rest[k]
        if rest is None:
            raise SceneError(f"{body.name}: pose: its mesh deforms, or a log added it")
        now = self.read()[0][body.vertices][rest[:, 0].astype(np.int64)]
        found, left = rigid(rest[:, 1:], now)
        if not left <= NEAR * (np.ptp(now, axis=0).max() or 1):
            raise SceneError(
                f"{body.name}: pose: its mesh was deformed by set_obstacle"
            )
        return found

    @property
    def pins(self) -> dict[str, Pins]:
        """The groups of pins, by their names."""
        return dict(self._groups)

    def pin(
        self,
        name: str,
        cloth: int | str | Body,
        particles: ArrayLike,
        *,
        targets: Any = None,
        follow: int | str | Body | None = None,
    ) -> Pins:
        """Pins particles as a group that is led and let go by itself. Those that the
        scene holds become a group, too, which is called "scene".

        Args:
            name: of the group, which no other has
            cloth: its number, name or `Body`
            particles: [n] numbers i + m·j, as `select` returns them
            targets: [n, 3] m, where they are at the end of the next step; None: they
                stay where they are
            follow: an obstacle, by its number, name or `Body`: whenever `set_pose`
                moves it, they move as if they were glued to it
        """
        k, body = self._one(cloth, "cloth")
        if name in self._groups:
            raise SceneError(f"pins {name!r}: there is such a group already")
        where = f"pins {name!r}"
        who = np.asarray(particles)
        who = scenes.array(
            who if who.size else np.empty(0, np.int32), (None,), where, np.int32
        )
        x = self.read()[0]
        if targets is None:
            if len(who) and not 0 <= who.min() <= who.max() < len(body.rest):
                raise SceneError(
                    f"{where}: expected particles 0 to {len(body.rest) - 1}"
                )
            goal = x[body.vertices][who]
        else:
            goal = scenes.array(targets, (len(who), 3), f"{where}: targets")
        group = Pins(self, name, k, who, goal)
        if follow is not None:
            self._seat(group, follow)
        held = self._held(k, body, x[body.vertices])
        for other in [*held, *self._of(k)]:
            twice = np.intersect1d(other.particles, who)
            if len(twice):
                raise SceneError(
                    f"{where}: particle {twice[0]} is in the group {other.name!r}"
                )
        self._apply(k, [*held, *self._of(k), group])
        self._groups.update({each.name: each for each in [*held, group]})
        return group

    def _seat(self, group: Pins, obstacle: int | str | Body) -> None:
        """Glues a group to an obstacle."""
        k, body = self._one(obstacle, "obstacle")
        if self._open().definition.obstacles[k].motion >= 0:
            raise SceneError(
                f"{body.name}: a motion of the scene moves it: pins of the scene that "
                "name this motion follow it"
            )
        position, rotation = self.pose(obstacle)
        group.follow = k
        group._seat = (group.targets - position) @ matrix(rotation)

    def _held(self, k: int, body: Body, x: Array) -> list[Pins]:
        """Returns the pins that the scene holds as a group, if no group is made of
        them yet, and a cloth has no other."""
        cloth = self._open().definition.cloths[k]
        if k in self._told or not cloth.n_pins:
            return []
        name = "scene" if "scene" not in self._groups else f"scene {k}"
        if cloth.pins == ffi.NULL or any(
            cloth.pins[i].motion >= 0 for i in range(cloth.n_pins)
        ):
            raise SceneError(
                f"{body.name}: its pins follow a motion of the scene, which groups "
                "would end; set_pins puts others in their place"
            )
        who = {cloth.pins[i].i + cloth.m * cloth.pins[i].j for i in range(cloth.n_pins)}
        ids = np.array(sorted(who), np.int32)
        return [Pins(self, name, k, ids, x[ids])]

    def _of(self, cloth: int) -> list[Pins]:
        """Returns the groups of a cloth."""
        return [each for each in self._groups.values() if each.cloth == cloth]

    def _apply(self, cloth: int, groups: Sequence[Pins]) -> None:
        """Tells the library all pins of a cloth."""
        who = np.concatenate(
            [np.empty(0, np.int32), *(each.particles for each in groups)]
        )
        goal = np.concatenate([np.empty((0, 3)), *(each.targets for each in groups)])
        self._put_pins(cloth, who, goal)
        self._told.add(cloth)

    def _set_group(self, group: Pins, targets: Array) -> None:
        if self._groups.get(group.name) is not group:
            raise SceneError(f"pins {group.name!r}: the group was let go")
        before, group.targets = group.targets, targets
        try:
            self._apply(group.cloth, self._of(group.cloth))
        except SceneError:
            group.targets = before
            raise

    def _drop_group(self, group: Pins) -> None:
        left = [each for each in self._of(group.cloth) if each is not group]
        if self._groups.get(group.name) is group:
            self._apply(group.cloth, left)
            del self._groups[group.name]

    def _carry(self, obstacle: int, pose: Pose) -> None:
        """Moves the groups that follow an obstacle to its pose of the next step."""
        turn = matrix(pose.rotation)
        for group in list(self._groups.values()):
            if group.follow == obstacle and group._seat is not None:
                self._set_group(group, group._seat @ turn.T + pose.position)

    def set_pins(
        self, cloth: int | str | Any, particles: ArrayLike, targets: Any = None
    ) -> None:
        """Sets which particles of a cloth are pinned, in place of all its pins and
        groups of pins.

        Args:
            cloth: its number, name or `Body`
            particles: [n] numbers i + m·j; n may be 0
            targets: [n, 3] m, where each is at the end of the next step; None:
                they stay where they are
        """
        k, _ = self._one(cloth, "cloth")
        self._put_pins(k, particles, targets)
        self._told.add(k)
        for group in self._of(k):
            del self._groups[group.name]

    def set_pose(
        self,
        obstacle: int | str | Any,
        position: scenes.Vector,
        rotation: scenes.Vector | None = None,
        pivot: scenes.Vector | None = None,
    ) -> None:
        """Tells an obstacle its pose at the end of the next step: its vertex X of
        the scene goes to position + R (X - pivot). Pins that follow it go with it.

        Args:
            obstacle: its number, name or `Body`
            position: [3] m
            rotation: [4] quaternion w, x, y, z of length 1; None: none
            pivot: [3] m; None: the origin
        """
        k = self._put_pose(obstacle, position, rotation, pivot)
        if any(group.follow == k for group in self._groups.values()):
            turn = np.asarray([1, 0, 0, 0] if rotation is None else rotation)
            centre = np.zeros(3) if pivot is None else np.asarray(pivot)
            at = np.asarray(position, np.float64) - matrix(turn) @ centre
            self._carry(k, Pose(at, turn))

    def set_obstacle(self, obstacle: int | str | Any, vertices: Any) -> None:
        """Tells an obstacle where its vertices, [n, 3] m, are at the end of the
        next step. Cloth in the way is pushed."""
        k, body = self._one(obstacle, "obstacle")
        for group in self._groups.values():
            if group.follow == k:
                raise SceneError(
                    f"{body.name}: vertices: pins {group.name!r} follow its pose: "
                    "move it by set_pose, or release them"
                )
        n = body.vertices.stop - body.vertices.start
        self._vectors("drape_set_obstacle", f"{body.name}: vertices", (k,), vertices, n)

    def _forget(self, kind: str, number: int) -> None:
        """Drops the groups of a body that goes, and renumbers the others."""

        def later(k: int) -> int:
            return k - (k > number)

        if kind == "cloth":
            self._told = {later(k) for k in self._told if k != number}
        for group in list(self._groups.values()):
            if kind == "cloth" and group.cloth == number:
                del self._groups[group.name]
            elif kind == "cloth":
                group.cloth = later(group.cloth)
            elif group.follow == number:
                group.follow = group._seat = None
            elif group.follow is not None:
                group.follow = later(group.follow)


def _least(away: Array, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns which one, among some, is the least far away."""
    found = np.zeros(len(away), bool)
    if among.any():
        found[np.argmin(np.where(among, away, np.inf))] = True
    return found
