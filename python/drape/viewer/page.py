# SPDX-License-Identifier: Apache-2.0
"""The page: bodies in a scene that orbits, and the controls beside it."""

from __future__ import annotations

import io
import socket
import threading
import time
from bisect import bisect_left
from collections.abc import Callable
from contextlib import redirect_stdout
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from drape.errors import Error
from drape.export import mesh
from drape.export.gltf import snapshot
from drape.export.run import Body
from drape.viewer import film, strain
from drape.viewer.gate import Gate
from drape.viewer.live import Live
from drape.viewer.source import Recorded, Source
from drape.viewer.stage import FAR, Stage, bar, display
from drape.viewer.touch import Touch

CLOTH, STRAIN = "cloth", "strain"
MOST = 60e6  # bytes a second that a playing page sends
AHEAD = 2  # frames that a live world may be ahead of the one that is shown
# Linear colours of forces, from none to the largest but for a few.
FORCES = np.array([[0.90, 0.68, 0.10], [0.62, 0.0, 0.02]])


class _Shape:
    """A body on the page: its surface, its wires, and its strain."""

    def __init__(
        self,
        server: viser.ViserServer,
        body: Body,
        number: int,
        x: NDArray[Any],
        stage: Stage,
    ) -> None:
        self.server, self.body, self.number = server, body, number
        self.small = bool(np.linalg.norm(np.ptp(x, axis=0)) <= FAR * stage.size)
        # a level floor is shown by the grid that lies in it
        self.ground = not self.small and stage.is_floor(x)
        self.path = f"/{number:03d} {body.name}"
        rgb = display(mesh.colour(body, number))
        server.scene.add_frame(self.path, show_axes=False)
        add, faces = server.scene.add_mesh_simple, body.faces.astype(np.uint32)
        self.surface = add(
            f"{self.path}/surface",
            x,
            faces,
            color=rgb,
            side="double",
            cast_shadow=self.small,
            visible=not self.ground,
        )
        dark = (20, 20, 20)
        self.wires = add(
            f"{self.path}/wires", x, faces, color=dark, wireframe=True, visible=False
        )
        self.strain: Any = None
        self.dragged = False
        """Whether the mouse may drag it."""

    def place(self, x: NDArray[Any], wires: bool, limit: float | None) -> None:
        """Shows the body at these positions; with colours of strain up to a limit."""
        strained = limit is not None and self.body.uv is not None
        # a surface that is dragged takes the mouse, clear over the colours of strain
        clear = strained and self.dragged
        self.surface.visible = not self.ground and (clear or not strained)
        self.surface.opacity = 0.0 if clear else None
        if self.surface.visible:
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


class _Flat:
    """The panels of garments, flat beside them, and the seams of both."""

    def __init__(self, server: viser.ViserServer, source: Source, stage: Stage) -> None:
        assert source.pattern
        self.pattern, flat = source.pattern, stage.pattern
        scene, width = server.scene, 0.009 * stage.size
        self.nodes: list[Any] = [scene.add_frame("/pattern", show_axes=False)]
        for k, x in flat.items():
            body = source.bodies[k]
            scene.add_mesh_simple(
                f"/pattern/{k:03d}",
                x.astype(np.float32),
                body.faces.astype(np.uint32),
                color=display(mesh.colour(body, k)),
                side="double",
                cast_shadow=False,
            )
            middle = (x.min(0) + x.max(0)) / 2
            name = f"/pattern/name {k:03d}"
            scene.add_label(name, body.name, position=middle, anchor="center-center")
        points, colours = self.pattern.lines(lambda k: flat[k])
        # viser takes colours of lines for linear ones
        linear = np.round(255 * mesh.linear(colours / 255)).astype(np.uint8)
        add = scene.add_line_segments
        add("/pattern/seams", points, linear, thickness=width)
        self.seams: Any = add("/seams", points, linear, thickness=width)
        self.nodes.append(self.seams)

    def show(self, on: bool, at: Callable[[int], NDArray[Any]]) -> None:
        """Shows panels and seams, or hides them. at: where a garment's panels are."""
        if on:
            self.seams.points = self.pattern.lines(at)[0].astype(np.float32)
        for node in self.nodes:
            node.visible = on


class Page:
    """Serves a source on a port, until `close`."""

    def __init__(
        self, source: Source, host: str, port: int, *, play: bool = True
    ) -> None:
        """Starts the server; `serve` keeps the page up to date."""
        self.source = source
        self.live = source if isinstance(source, Live) and source.paced else None
        self.frames = list(source.frames())
        self.playing = play
        self.shown: int | None = None
        """The number of the frame that is on the page."""
        self._dirty = threading.Event()
        self._closed = threading.Event()
        self._serving = threading.Lock()
        self._due, self._ask = 0.0, 0
        self.host, self.gate = host, Gate(host)
        with redirect_stdout(io.StringIO()), self.gate.before():  # viser greets
            self.server = viser.ViserServer(host=host, port=port, verbose=False)
            if not self.gate.watched:
                self.server.stop()
                raise Error("this version of viser cannot be guarded from other pages")
        self.stage = Stage(self.server, source)
        self._shapes = [self._shape(k, body) for k, body in enumerate(source.bodies)]
        self._flat = _Flat(self.server, source, self.stage) if source.pattern else None
        self._controls()
        self.touch = Touch(self.server, self.live) if self.live else None
        self._keys()
        if self.touch:
            for shape in self._shapes:
                self._let_drag(shape, self.touch)
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

    def _shape(self, number: int, body: Body) -> _Shape:
        x = self._positions(body, self.frames[0])
        return _Shape(self.server, body, number, x, self.stage)

    def _let_drag(self, shape: _Shape, touch: Touch) -> None:
        """Lets a body be dragged, but for ground and what moves by itself."""
        if shape.body.kind == "obstacle" and (shape.body.moving or not shape.small):
            return

        shape.dragged = True
        touch.drag(shape.surface, shape.number)

    def _controls(self) -> None:
        gui, count = self.server.gui, len(self.frames)
        gui.configure_theme(show_share_button=False, show_logo=False)
        # beside the picture they do not cover what is framed in it
        gui.main_panel.dock_right()
        gui.set_panel_label(f"drape: {self.source.title}")
        self.words = gui.add_markdown("")
        self.play: Any = gui.add_button("Pause" if self.playing else "Play")
        self.steps: Any = gui.add_button_group("Step", ("back", "on", "first", "last"))
        self.frame: Any = gui.add_slider("Frame", 0, max(count - 1, 1), 1, 0)
        self.speed: Any = gui.add_slider("Speed", 0.05, 2.0, 0.05, 1.0)
        self.loop: Any = gui.add_checkbox("Loop", True, visible=self.live is None)
        self.wires: Any = gui.add_checkbox("Wires", False)
        strained = any(body.uv is not None for body in self.source.bodies)
        kinds = (CLOTH, STRAIN) if strained else (CLOTH,)
        self.colour: Any = gui.add_dropdown("Colour", kinds, visible=strained)
        self.limit: Any = gui.add_slider("Strain at full colour, %", 0.1, 20, 0.1, 2)
        self.limit.visible = False  # until there is strain to colour
        self.strain_bar: Any = gui.add_html("", visible=False)
        known = self.source.contacts(self.frames[0]) is not None
        self.contacts: Any = gui.add_checkbox("Contacts", False, disabled=not known)
        if not known:
            gui.add_markdown(f"*{self.source.no_contacts}*")
        self.arrows: Any = gui.add_slider("Arrow, mm for 1 mN", 0.0, 100.0, 0.1, 2.0)
        self.arrows.visible = False
        self.force_bar: Any = gui.add_html("", visible=False)
        self._pattern_controls()
        if isinstance(self.source, Recorded):
            film.add_button(self.server, self.source.run)
        self.play.on_click(lambda _: self._toggle())
        self.steps.on_click(lambda _: self._go(self.steps.value))
        for control in (
            *(self.frame, self.wires, self.colour, self.limit),
            *(self.contacts, self.arrows, self.pattern),
        ):
            control.on_update(lambda _: self._dirty.set())

    def _pattern_controls(self) -> None:
        gui, there = self.server.gui, self._flat is not None
        self.pattern: Any = gui.add_checkbox("Pattern", there, visible=there)
        if self._flat:
            with gui.add_folder("Seams", expand_by_default=False):
                gui.add_html(self._flat.pattern.legend())
            self.pattern.on_update(lambda _: self.stage.frame(self.pattern.value))

    def _keys(self) -> None:
        """Gives the controls keys, and lists these."""

        def switch(box: Any) -> Callable[[], None]:
            return lambda: setattr(box, "value", not box.value)

        def colour() -> None:
            options = self.colour.options
            at = options.index(self.colour.value) + 1
            self.colour.value = options[at % len(options)]

        keys: list[tuple[Any, str, Callable[[], None]]] = [
            ("space", "play or pause", self._toggle),
            ("arrowright", "a frame on", lambda: self._go("on")),
            ("arrowleft", "a frame back", lambda: self._go("back")),
            ("home", "the first frame", lambda: self._go("first")),
            ("F", "see all", lambda: self.stage.look(self.server)),
            ("W", "wires", switch(self.wires)),
            ("C", "colour of strain", colour),
        ]
        if self.touch:
            keys.append(("R", "restart", self.touch.again))
        else:
            keys.append(("L", "loop", switch(self.loop)))
        if self._flat:
            keys.append(("P", "pattern", switch(self.pattern)))
        if not self.contacts.disabled:
            keys.append(("T", "contacts", switch(self.contacts)))
        names = {"arrowright": "→", "arrowleft": "←"}
        lines = []
        for key, what, call in keys:
            command = self.server.gui.add_command(what.capitalize(), hotkey=key)
            command.on_trigger(lambda _, call=call: call())
            lines.append(f"`{names.get(key, key)}` {what}")
        with self.server.gui.add_folder("Keys", expand_by_default=False):
            mouse = "drag: turn, right: move, wheel: nearer"
            self.server.gui.add_markdown("  \n".join([*lines, mouse]))

    def _toggle(self) -> None:
        self.playing = not self.playing
        if self.playing and not self._more() and not self.loop.value:
            self.frame.value = 0
        self.play.label = "Pause" if self.playing else "Play"
        self._due = time.monotonic()

    def _pause(self) -> None:
        self.playing = False
        self.play.label = "Play"

    def _more(self) -> bool:
        """Whether there is, or may be, a frame after the one that is shown."""
        last = int(self.frame.value) >= len(self.frames) - 1
        return not last or self.live is not None or self.source.growing()

    def _go(self, where: str) -> None:
        """Pauses, and goes to another frame."""
        self._pause()
        at, last = int(self.frame.value), len(self.frames) - 1
        if where == "on" and at >= last and self.live is not None:
            self._ask = 1
            self.source.want(self.frames[-1] + 1)
            return
        to = {"first": 0, "last": last, "back": max(at - 1, 0), "on": min(at + 1, last)}
        self.frame.value = to[where]

    def _show_contacts(self, frame: int) -> None:
        on = bool(self.contacts.value)
        found = self.source.contacts(frame) if on else None
        scene = self.server.scene
        none = np.zeros((0, 3), np.float32)
        points = found.points if found else none
        forces = found.forces if found else none
        size = np.linalg.norm(forces, axis=1)
        # a few contacts may press much harder than all others
        most = float(np.percentile(size, 95)) if size.any() else 0.0
        share = np.clip(size / (most or 1), 0, 1)[:, None]
        ends = np.array([display(rgb) for rgb in FORCES])
        rgb = (ends[0] + share * (ends[1] - ends[0])).astype(np.uint8)
        shown = on and most > 0
        if shown:
            words = ("0", f"{most:.2g} N and more")
            self.force_bar.content = bar("Force of a contact", FORCES, words)
        self.force_bar.visible = shown
        self.arrows.visible = on
        scene.add_point_cloud(
            "/contacts",
            points,
            rgb,
            point_size=0.004 * self.stage.size,
            point_shape="circle",
            precision="float32",
        )
        arrows = float(self.arrows.value) * forces  # mm for 1 mN is m for 1 N
        head = 0.015 * self.stage.size
        long = np.linalg.norm(arrows, axis=1) > head
        tips = points + arrows
        scene.add_arrows(
            "/forces",
            np.stack([points, tips], 1)[long],
            rgb[long],
            shaft_radius=0.2 * head,
            head_radius=0.4 * head,
            head_length=head,
        )

    def _show_strain(self) -> float | None:
        """Shows what the colours of strain mean; returns their limit, None: none."""
        on = self.colour.value == STRAIN
        self.limit.visible = self.strain_bar.visible = on
        if not on:
            return None
        percent = float(self.limit.value)
        words = (f"pressed {percent:g} %", "0", f"stretched {percent:g} %")
        self.strain_bar.content = bar("Strain", strain.SCALE, words)
        return percent / 100

    def _show(self, all_: bool) -> None:
        """Brings the page to the state of its controls: all, or what moves."""
        frame = self.frames[min(int(self.frame.value), len(self.frames) - 1)]
        with self.server.atomic():
            limit = self._show_strain()
            for shape in self._shapes:
                if self.source.bodies[shape.number].moving or all_:
                    x = self._positions(shape.body, frame)
                    shape.place(x, bool(self.wires.value), limit)
            if self._flat and (all_ or self.pattern.value):
                bodies = self.source.bodies
                self._flat.show(
                    bool(self.pattern.value),
                    lambda k: self._positions(bodies[k], frame),
                )
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
        last = int(self.frame.value) >= len(self.frames) - 1
        again = frames[-1] < self.frames[-1]  # the world was put back
        came, self.frames = frames[-1] - self.frames[-1], frames
        self.frame.max = max(len(frames) - 1, 1)
        # a source may have dropped frames before this one
        self.frame.value = min(bisect_left(frames, now), len(frames) - 1)
        if again:
            self._dirty.set()
        elif last and not self.playing and self.live is not None and came:
            self._ask = came  # somebody steps the world, or asked for a frame

    def _advance(self) -> bool:
        """Goes to the frame of this moment while it plays; whether it moved."""
        now = time.monotonic()
        if not (self.playing or self._ask) or now < self._due:
            return False
        at, last = int(self.frame.value), len(self.frames) - 1
        if self.playing:
            self.source.want(self.frames[min(at, last)] + AHEAD)
        if at >= last and (self._growing or self.live is not None):
            return False
        if at >= last and not self.loop.value:
            self._pause()
            return False
        step = 1 if at < last else -at
        apart = self.frames[min(at + 1, last)] - self.frames[min(at, last)]
        wait = max(apart, 1) * self.source.seconds / float(self.speed.value)
        moving = (b for b in self.source.bodies if b.moving)
        bytes_ = sum(12 * len(body.rows) for body in moving)
        self._due = max(self._due + max(wait, bytes_ / MOST), now - 0.1)
        self._ask = max(self._ask - 1, 0)
        self.frame.value = at + step
        return step != 0

    def serve(self) -> None:
        """Keeps the page up to date, until `close`."""
        with self._serving:
            self._serve()

    def _serve(self) -> None:
        looked = 0.0
        self._growing = self.source.growing()
        while not self._closed.is_set():
            often = 0.0 if self.live is not None else 0.25
            if self._growing and time.monotonic() > looked + often:
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
        with self._serving, redirect_stdout(io.StringIO()):
            self.source.close()
            self.server.stop()
