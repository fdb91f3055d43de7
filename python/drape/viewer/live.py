# SPDX-License-Identifier: Apache-2.0
"""A world that is computed while it is shown, and that can be touched."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drape._define import tree_of
from drape.errors import DivergedError, Error, SceneError
from drape.export.run import Body, Positions, make_body, make_cloth
from drape.pins import Pins
from drape.viewer.pattern import pattern_of
from drape.viewer.source import Contacts, on_cloths, step_words
from drape.world import World, outcome_names

MOST = 5e8  # bytes of frames that are kept
NEAR = 1.6  # cells about a point that is dragged, which go with it
SPEED = 2.0  # sizes of the cloths a second, that what is dragged goes at most
GRIP = "what is dragged"  # the group of pins

Task = Callable[[World], None]


def contacts_of(world: World) -> Contacts | None:
    """The contacts of the world's last step; None of an explicit integrator's."""
    try:
        pairs = world.contacts()
    except SceneError:
        return None
    cloths = sum(body.kind == "cloth" for body in world.bodies)
    forces = on_cloths(pairs.bodies, pairs.impulses, cloths) / (pairs.dt or 1)
    points = pairs.places(world.read()[0])
    return Contacts(points.astype(np.float32), forces.astype(np.float32))


def _colour(looks: Any, k: int) -> tuple[float, float, float] | None:
    """What a scene says of the colour of one of its bodies; None: nothing."""
    if not looks or looks[k].colour[0] < 0:
        return None
    r, g, b = looks[k].colour
    return r, g, b


def _body(world: World, k: int) -> Body:
    """A body of the world, as a page shows it."""
    body, handle = world.bodies[k], world._open()
    tri, scene = world.triangles[body.triangles], handle.scene
    if body.particles is None or body.size is None:
        k -= handle.definition.n_cloths
        obstacle = handle.definition.obstacles[k]
        moving = obstacle.motion >= 0 or obstacle.frames > 0
        made = make_body(body.name, tri, moving)
        return replace(made, colour=_colour(scene.obstacle_look, k))
    first = body.vertices.start
    made = make_cloth(body.name, tri, first, body.particles, body.size, body.rest)
    return replace(made, colour=_colour(scene.cloth_look, k))


class Grip:
    """What is dragged: particles of a cloth, or an obstacle, and where to."""

    def __init__(self, world: World, number: int, point: NDArray[np.float64]) -> None:
        """Takes hold of body `number` of the world at a point, m."""
        self.goal = self.at = point
        body, x = world.bodies[number], world.read()[0]
        self._pins: Pins | None = None
        self._obstacle = number
        if body.particles is None or body.size is None:
            self._pose = world.pose(body)
            return
        (m, n), (width, height) = body.particles, body.size
        cell = max(width / (m - 1), height / (n - 1))
        [nearest] = world.select(body, near=point)
        middle = x[body.vertices.start + nearest]
        who = world.select(body, near=middle, radius=NEAR * cell)
        for group in world.pins.values():
            if group.cloth == number:
                who = np.setdiff1d(who, group.particles)
        self._pins = world.pin(GRIP, body, who)

    def lead(self, world: World, most: float) -> None:
        """Tells what is held where it is after the next step, at most so far, m."""
        by = self.goal - self.at
        far = float(np.linalg.norm(by))
        by = by * min(1, most / far) if far else by
        self.at = self.at + by
        if self._pins is not None:
            self._pins.move(by)
        else:
            body = world.bodies[self._obstacle]
            position, rotation = self._pose
            self._pose = type(self._pose)(position + by, rotation)
            world.set_pose(body, *self._pose)

    def drop(self) -> None:
        """Lets go."""
        if self._pins is not None:
            self._pins.release()


class Live:
    """A world that a thread steps. The latest frames are kept in memory.

    A paced one makes the frames that are wanted, without an end, and does what it
    is told between two steps; another one makes the scene's frames at once.
    """

    no_contacts = "an explicit integrator lists no contacts"

    def __init__(self, scene: str | Path | World, paced: bool = False) -> None:
        """Takes a world, or makes that of a scene's file, and starts the thread."""
        world = scene if isinstance(scene, World) else World(scene)
        self.world = world
        self.title = world.name
        self._bodies = [_body(world, k) for k in range(len(world.bodies))]
        self.pattern = pattern_of(world, self._bodies)
        self.bodies: Sequence[Body] = self._bodies
        self.seconds = world.dt * world.steps_per_frame
        self.camera: dict[str, Any] | None = tree_of(world._text).get("camera")
        self._lock = threading.Lock()
        self._x: dict[int, Positions] = {}
        self._contacts: dict[int, Contacts | None] = {}
        self._words: dict[int, str] = {}
        self._stop = False
        self._fault: BaseException | None = None
        self._signal = threading.Condition()
        self._tasks: list[Task] = []
        self._wanted: int | None = 0 if paced else None
        self._start = world.checkpoint() if paced else b""
        self._grip: Grip | None = None
        self._frame = 0
        self._said = ""
        x = world.read()[0][: world.bodies[0].vertices.stop]
        self._size = float(np.linalg.norm(np.ptp(x, axis=0)))
        self._keep("")
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def _keep(self, words: str, alone: bool = False) -> None:
        """Keeps the world's state as a frame, and drops the oldest beyond MOST, or all
        others."""
        x, contacts = self.world.read()[0], contacts_of(self.world)
        if self.world.precision == 32:
            x = x.astype(np.float32)
        with self._lock:
            for kept in (self._x, self._words, self._contacts) if alone else ():
                kept.clear()
            before = next(reversed(self._x.values())) if self._x else x
            for k, body in enumerate(self._bodies):  # set_pose may move an obstacle
                if not body.moving and (before[body.rows[0]] != x[body.rows[0]]).any():
                    self._bodies[k] = replace(body, moving=True)
            self._x[self._frame], self._words[self._frame] = x, words
            self._contacts[self._frame] = contacts
            self._known = self.world.steps
            while len(self._x) > 2 and len(self._x) * x.nbytes > MOST:
                oldest = next(iter(self._x))
                for kept in (self._x, self._words, self._contacts):
                    del kept[oldest]

    # What the thread does

    def _due(self) -> bool:
        """Whether another frame is to be made."""
        wanted = self.world.frames if self._wanted is None else self._wanted
        return self._frame < wanted

    def _work(self) -> None:
        try:
            while not self._stop and (self._wanted is not None or self._due()):
                with self._signal:
                    if not self._tasks and not self._due():
                        self._signal.wait(0.05)
                    tasks, self._tasks = self._tasks, []
                for task in tasks:
                    self._try(task)
                if self._due() and not self._stop:
                    self._advance()
                elif self.world.steps != self._known:  # somebody else has stepped it
                    self._frame += 1
                    self._keep(self._last_words())
        except DivergedError as error:
            self._say(str(error))
        except Exception as error:  # what `growing` tells the page
            self._fault = error

    def _try(self, task: Task) -> None:
        """Does what the page asks for; what is refused is told on the page."""
        try:
            task(self.world)
            self._said = ""
        except Error as error:
            self._say(str(error))

    def _say(self, text: str) -> None:
        self._said = text
        with self._lock:
            self._words[max(self._words)] += f"  \n{text}"

    def _advance(self) -> None:
        """Makes a frame."""
        for _ in range(self.world.steps_per_frame):
            if self._stop:
                return
            if self._grip is not None:
                self._grip.lead(self.world, SPEED * self._size * self.world.dt)
            try:
                self.world.step()
            except DivergedError:
                if self._wanted is None:
                    raise
                self._wanted = self._frame
                self._say("the step diverged; Restart begins again")
                return
        self._frame += 1
        self._keep(self._last_words())

    def _last_words(self) -> str:
        report = self.world.report
        if report is None:
            return ""
        words = step_words(
            outcome_names(report.outcome).lower() or "clean",
            report.contacts,
            report.rounds,
            report.iterations,
        )
        return words + (f"  \n{self._said}" if self._said else "")

    # What a page asks for

    def do(self, task: Task) -> None:
        """Has the thread call this with the world between two steps."""
        with self._signal:
            self._tasks.append(task)
            self._signal.notify()

    def want(self, frame: int) -> None:
        """Has frames made up to this one, if the source is a paced one."""
        with self._signal:
            if self._wanted is not None:
                self._wanted = frame
                self._signal.notify()

    @property
    def paced(self) -> bool:
        """Whether it does what it is told."""
        return self._wanted is not None

    def grab(self, number: int, point: Sequence[float]) -> None:
        """Takes hold of a body at a point, m."""
        at = np.array(point, np.float64)

        def take(world: World) -> None:
            if self._grip is not None:
                self._grip.drop()
            self._grip = None
            self._grip = Grip(world, number, at)

        self.do(take)

    def pull(self, point: Sequence[float]) -> None:
        """Says where what is held is to go, m."""
        goal = np.array(point, np.float64)

        def lead(_: World) -> None:
            if self._grip is not None:
                self._grip.goal = goal

        self.do(lead)

    def drop(self) -> None:
        """Lets go of what is held."""

        def let_go(_: World) -> None:
            grip, self._grip = self._grip, None
            if grip is not None:
                grip.drop()

        self.do(let_go)

    def restart(self) -> None:
        """Puts the world back to where it was when it was first shown."""

        def again(world: World) -> None:
            self._grip = None
            world.restore(self._start)
            self._frame = self._wanted = 0
            self._keep("", alone=True)

        self.do(again)

    # What it tells

    def frames(self) -> Sequence[int]:
        """The numbers of the frames that are kept."""
        with self._lock:
            return list(self._x)

    def growing(self) -> bool:
        """Whether the thread works; raises what it has failed of."""
        if self._fault:
            raise self._fault
        return self._thread.is_alive()

    def positions(self, body: Body, frame: int) -> Positions:
        """The vertices of a body, [vertices, 3] m; of the oldest frame that is
        kept, if this one was dropped."""
        with self._lock:
            x = self._x.get(frame)
            return (next(iter(self._x.values())) if x is None else x)[body.rows]

    def contacts(self, frame: int) -> Contacts | None:
        """The contacts of a frame; None where the world does not tell them."""
        with self._lock:
            return self._contacts.get(frame)

    def words(self, frame: int) -> str:
        """The report of the frame's last step."""
        with self._lock:
            return self._words.get(frame, "")

    def close(self) -> None:
        """Ends the thread after its step."""
        self._stop = True
        with self._signal:
            self._signal.notify()
        self._thread.join()
