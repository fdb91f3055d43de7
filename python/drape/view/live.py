# SPDX-License-Identifier: Apache-2.0
"""A scene that is computed while it is shown."""

from __future__ import annotations

import json
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drape.errors import DivergedError, SceneError
from drape.export.run import Body, Positions, make_body, make_cloth
from drape.view.source import Contacts, on_cloths, step_words
from drape.world import World, outcome_names

MOST = 2e9  # bytes of frames that are kept


def contacts_of(world: World) -> Contacts | None:
    """The contacts of the world's last step; None of an explicit integrator's."""
    try:
        pairs = world.contacts()
    except SceneError:
        return None
    cloths = sum(body.kind == "cloth" for body in world.bodies)
    impulses = on_cloths(pairs.bodies, pairs.impulses, cloths)
    points = pairs.places(world.read()[0])
    return Contacts(points.astype(np.float32), impulses.astype(np.float32))


def _body(world: World, k: int) -> Body:
    """A body of the world, as a page shows it."""
    body = world.bodies[k]
    tri = world.triangles[body.triangles]
    if body.particles is None or body.size is None:
        definition = world._open().definition
        obstacle = definition.obstacles[k - definition.n_cloths]
        return make_body(body.name, tri, obstacle.motion >= 0 or obstacle.frames > 0)
    first = body.vertices.start
    return make_cloth(body.name, tri, first, body.particles, body.size)


class Live:
    """A world that a thread steps. The latest frames are kept in memory."""

    def __init__(self, scene: str | Path) -> None:
        """Makes the world of a scene's file, and starts the thread."""
        self._world = world = World(scene)
        self.title = world.name
        self.bodies: Sequence[Body] = [
            _body(world, k) for k in range(len(world.bodies))
        ]
        self.seconds = world.dt * world.steps_per_frame
        text = json.loads(Path(scene).read_text(encoding="utf-8"))
        self.camera: dict[str, Any] | None = text.get("camera")
        self._lock = threading.Lock()
        self._x: dict[int, Positions] = {}
        self._contacts: dict[int, Contacts | None] = {}
        self._words: dict[int, str] = {}
        self._stop = threading.Event()
        self._fault: BaseException | None = None
        self._keep(0, "")
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def _keep(self, frame: int, words: str) -> None:
        """Keeps the world's state as a frame, and drops the oldest beyond MOST."""
        x = self._world.read()[0]
        if self._world.precision == 32:
            x = x.astype(np.float32)
        with self._lock:
            self._x[frame], self._words[frame] = x, words
            self._contacts[frame] = contacts_of(self._world)
            while len(self._x) > 2 and len(self._x) * x.nbytes > MOST:
                oldest = next(iter(self._x))
                for kept in (self._x, self._words, self._contacts):
                    del kept[oldest]

    def _work(self) -> None:
        try:
            for frame in range(1, self._world.frames + 1):
                for _ in range(self._world.steps_per_frame):
                    if self._stop.is_set():
                        return
                    [report] = self._world.step()
                words = step_words(
                    outcome_names(report.outcome).lower() or "clean",
                    report.contacts,
                    report.rounds,
                    report.iterations,
                )
                self._keep(frame, words)
        except DivergedError as error:
            with self._lock:
                self._words[max(self._words)] += f"  \n{error}"
        except Exception as error:  # what `growing` tells the page
            self._fault = error

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
        self._stop.set()
        self._thread.join()
