# SPDX-License-Identifier: Apache-2.0
"""The page: bodies in a scene that orbits, and the controls beside it."""

from __future__ import annotations

import io
import socket
import threading
import time
from bisect import bisect_left
from contextlib import redirect_stdout
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from drape.errors import Error
from drape.export import mesh
from drape.export.gltf import snapshot
from drape.export.run import Body
from drape.view import strain
from drape.view.gate import Gate
from drape.view.source import Source

CLOTH, STRAIN = "cloth", "strain"
MOST = 60e6  # bytes a second that a playing page sends


def display(linear: tuple[float, float, float]) -> tuple[int, int, int]:
    """A linear colour as the 8 bits of a screen."""
    a = np.array(linear)
    s = np.where(a <= 0.0031308, 12.92 * a, 1.055 * a ** (1 / 2.4) - 0.055)
    r, g, b = (int(c) for c in np.round(255 * s))
    return r, g, b


class _Shape:
    """A body on the page: its surface, its wires, and its strain."""

    def __init__(
        self, server: viser.ViserServer, body: Body, number: int, x: NDArray[Any]
    ) -> None:
        self.server, self.body = server, body
        self.path = f"/{number:03d} {body.name}"
        rgb = display(mesh.colour(body, number))
        server.scene.add_frame(self.path, show_axes=False)
        add, faces = server.scene.add_mesh_simple, body.faces.astype(np.uint32)
        self.surface = add(f"{self.path}/surface", x, faces, color=rgb, side="double")
        dark = (20, 20, 20)
        self.wires = add(
            f"{self.path}/wires", x, faces, color=dark, wireframe=True, visible=False
        )
        self.strain: Any = None

    def place(self, x: NDArray[Any], wires: bool, limit: float | None) -> None:
        """Shows the body at these positions; with colours of strain up to a limit."""
        strained = limit is not None and self.body.kind == "cloth"
        self.surface.visible = not strained
        if not strained:
            self.surface.vertices = x
        if wires:
            self.wires.vertices = x
        self.wires.visible = wires
        if limit is not None and strained:
            rgb = strain.colours(strain.at_vertices(self.body, x), limit)
            normal = mesh.vertex_normals(x, self.body.faces)
            data = snapshot(x, normal, self.body.faces, rgb)
            if self.strain is None:
                self.strain = self.server.scene.add_glb(f"{self.path}/strain", data)
            else:
                self.strain.glb_data = data
        if self.strain is not None:
            self.strain.visible = strained


class Page:
    """Serves a source on a port, until `close`."""

    def __init__(self, source: Source, host: str, port: int) -> None:
        """Starts the server; `serve` keeps the page up to date."""
        self.source = source
        self.frames = list(source.frames())
        self.shown: int | None = None
        """The number of the frame that is on the page."""
        self._dirty = threading.Event()
        self._closed = threading.Event()
        self._due = 0.0
        self.host, self.gate = host, Gate(host)
        with redirect_stdout(io.StringIO()), self.gate.before():  # viser greets
            self.server = viser.ViserServer(host=host, port=port, verbose=False)
            if not self.gate.watched:
                self.server.stop()
                raise Error("this version of viser cannot be guarded from other pages")
        self.server.scene.set_up_direction("+y")
        self._bounds()
        self._camera()
        self._shapes = [
            _Shape(self.server, b, k, self._positions(b, self.frames[0]))
            for k, b in enumerate(source.bodies)
        ]
        self._controls()
        self._dirty.set()

    @property
    def port(self) -> int:
        """The port, which is another one than asked for if that was taken."""
        return int(self.server.get_port())

    @property
    def url(self) -> str:
        """The page's address, with the token if it asks for one."""
        host = socket.gethostname() if self.host in ("0.0.0.0", "::") else self.host
        name = f"[{host}]" if ":" in host else host
        token = f"/?token={self.gate.token}" if self.gate.token else ""
        return f"http://{name}:{self.port}{token}"

    def _positions(self, body: Body, frame: int) -> NDArray[Any]:
        return self.source.positions(body, frame).astype(np.float32)

    def _bounds(self) -> None:
        """Finds the box of the cloths, by which things get their size."""
        cloths = [b for b in self.source.bodies if b.kind == "cloth"]
        x = np.concatenate([self._positions(b, self.frames[0]) for b in cloths])
        self._middle = (x.min(0) + x.max(0)) / 2
        self._size = float(np.linalg.norm(x.max(0) - x.min(0)))

    def _camera(self) -> None:
        camera, start = self.source.camera or {}, self.server.initial_camera
        eye, target = camera.get("eye"), camera.get("target")
        start.fov = np.radians(camera.get("fov", 35))
        # a report's camera of which both are one place is one that sees all
        if eye and target and list(eye) != list(target):
            start.position, start.look_at = eye, target
        else:
            away = np.array([0.5, 0.4, 1.0]) * 1.6 * self._size
            start.position, start.look_at = self._middle + away, self._middle

    def _controls(self) -> None:
        gui, count = self.server.gui, len(self.frames)
        gui.configure_theme(show_share_button=False, show_logo=False)
        self.server.gui.set_panel_label(f"drape: {self.source.title}")
        self.words = gui.add_markdown("")
        self.play = gui.add_button("Pause" if self.source.growing() else "Play")
        self.playing = self.source.growing()
        self.frame: Any = gui.add_slider("Frame", 0, max(count - 1, 1), 1, 0)
        self.speed: Any = gui.add_slider("Speed", 0.05, 2.0, 0.05, 1.0)
        self.wires = gui.add_checkbox("Wires", False)
        self.colour = gui.add_dropdown("Colour", (CLOTH, STRAIN))
        self.limit = gui.add_slider("Strain at full colour, %", 0.1, 20, 0.1, 2)
        known = self.source.contacts(self.frames[0]) is not None
        hint = None if known else "The run was made without --contacts."
        self.contacts = gui.add_checkbox("Contacts", known, disabled=not known)
        self.contacts.hint = hint
        self.arrows = gui.add_slider("Arrow, m for 1 mN·s", 0.0, 1.0, 0.01, 0.05)
        self.arrows.disabled = not known
        self.play.on_click(lambda _: self._toggle())
        for control in (
            *(self.frame, self.wires, self.colour, self.limit),
            *(self.contacts, self.arrows),
        ):
            control.on_update(lambda _: self._dirty.set())
        self.limit.disabled = True  # until there is strain to colour
        self.colour.on_update(lambda _: self._enable())

    def _enable(self) -> None:
        self.limit.disabled = self.colour.value != STRAIN

    def _toggle(self) -> None:
        self.playing = not self.playing
        self.play.label = "Pause" if self.playing else "Play"
        self._due = time.monotonic()

    def _show_contacts(self, frame: int) -> None:
        on = bool(self.contacts.value)
        found = self.source.contacts(frame) if on else None
        scene = self.server.scene
        none = np.zeros((0, 3), np.float32)
        points = found.points if found else none
        impulses = found.impulses if found else none
        size = np.linalg.norm(impulses, axis=1)
        # a few contacts may press much harder than all others
        most = np.percentile(size, 95) if size.any() else 0
        share = np.clip(size / (most or 1), 0, 1)
        rgb = np.stack([255 * share, 200 * (1 - share), 40 + 0 * share], 1)
        scene.add_point_cloud(
            "/contacts",
            points,
            rgb.astype(np.uint8),
            point_size=0.006 * self._size,
            point_shape="circle",
            precision="float32",
        )
        arrows = 1e3 * float(self.arrows.value) * impulses
        head = 0.015 * self._size
        long = np.linalg.norm(arrows, axis=1) > head
        tips = points + arrows
        scene.add_arrows(
            "/impulses",
            np.stack([points, tips], 1)[long],
            rgb.astype(np.uint8)[long],
            shaft_radius=0.2 * head,
            head_radius=0.4 * head,
            head_length=head,
        )

    def _show(self, all_: bool) -> None:
        """Brings the page to the state of its controls: all, or what moves."""
        frame = self.frames[min(int(self.frame.value), len(self.frames) - 1)]
        limit = self.limit.value / 100 if self.colour.value == STRAIN else None
        with self.server.atomic():
            for shape in self._shapes:
                if shape.body.moving or all_:
                    x = self._positions(shape.body, frame)
                    shape.place(x, bool(self.wires.value), limit)
            if not self.contacts.disabled:
                self._show_contacts(frame)
        words = self.source.words(frame)
        self.words.content = (
            f"**frame {frame}**, {frame * self.source.seconds:.3f} s"
            + (f"  \n{words}" if words else "")
        )
        self.shown = frame

    def _grow(self) -> None:
        """Takes the frames that have come since, and stays at the one that is shown."""
        frames = list(self.source.frames())
        if frames == self.frames:
            return
        now = self.frames[min(int(self.frame.value), len(self.frames) - 1)]
        self.frames = frames
        self.frame.max = max(len(frames) - 1, 1)
        # a source may have dropped frames before this one
        self.frame.value = min(bisect_left(frames, now), len(frames) - 1)

    def _advance(self) -> bool:
        """Goes to the frame of this moment while it plays; whether it moved."""
        now = time.monotonic()
        if not self.playing or now < self._due:
            return False
        at, last = int(self.frame.value), len(self.frames) - 1
        if at >= last and self._growing:
            return False
        step = 1 if at < last else -at
        apart = self.frames[min(at + 1, last)] - self.frames[min(at, last)]
        wait = max(apart, 1) * self.source.seconds / float(self.speed.value)
        bytes_ = sum(12 * len(s.body.rows) for s in self._shapes if s.body.moving)
        self._due = max(self._due + max(wait, bytes_ / MOST), now - 0.1)
        self.frame.value = at + step
        return True

    def serve(self) -> None:
        """Keeps the page up to date, until `close`."""
        looked = 0.0
        self._growing = self.source.growing()
        while not self._closed.is_set():
            if self._growing and time.monotonic() > looked + 0.25:
                looked = time.monotonic()
                self._growing = self.source.growing()
                self._grow()
            # cleared first: what changes while the page is drawn is drawn next
            changed = self._dirty.wait(0.01)
            if changed:
                self._dirty.clear()
            if self._advance() or changed:
                self._show(changed)

    def close(self) -> None:
        """Ends `serve`, the server and what makes the frames."""
        self._closed.set()
        self._dirty.set()
        self.source.close()
        with redirect_stdout(io.StringIO()):
            self.server.stop()
