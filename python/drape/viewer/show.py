# SPDX-License-Identifier: Apache-2.0
"""drape.view: shows a world, a run or a mesh on a page for a web browser."""

from __future__ import annotations

import html
import logging
import os
import sys
import threading
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from drape._closing import Closing
from drape._meshes import mesh_of
from drape.errors import SceneError, need
from drape.meshes import Mesh
from drape.scene import Scene, array
from drape.viewer.live import Live
from drape.viewer.source import Meshes, Source
from drape.world import World

if TYPE_CHECKING:
    from drape.viewer.page import Page

PACKAGES = "viser", "pygltflib"  # of the extra `view`


class Viewer(Closing):
    """A page that is served by a thread until `close`; `drape.view` makes one.

    Attributes:
        url: its address
    """

    def __init__(self, page: Page) -> None:
        """Serves the page."""
        self._page, self.url = page, page.url
        self._thread = threading.Thread(target=page.serve, daemon=True)
        self._thread.start()

    def __repr__(self) -> str:
        """The page's address."""
        return f"<drape.Viewer {self.url}>"

    def _repr_html_(self) -> str:
        """The page itself, in a notebook."""
        url = html.escape(self.url)
        return (
            f'<iframe src="{url}" width="100%" height="600" style="border: 0"></iframe>'
            f'<a href="{url}">{url}</a>'
        )

    def wait(self) -> None:
        """Waits until Ctrl-C, and closes the page."""
        try:
            self._thread.join()
        except KeyboardInterrupt:
            print()
        finally:
            self.close()

    def close(self) -> None:
        """Ends the page. A world that was shown goes on as it is."""
        self._page.close()
        self._thread.join()


def is_prompt() -> bool:
    """Whether Python is used at a prompt or in a notebook, and not by a script."""
    return (
        hasattr(sys, "ps1") or bool(sys.flags.interactive) or "ipykernel" in sys.modules
    )


def _source(what: Any, triangles: ArrayLike | None, dt: float) -> Source:
    """Returns what a page can show."""
    from drape.viewer.cli import open_source

    if triangles is not None:
        x = np.asarray(what)
        x = array(x, (None,) * x.ndim, "positions")
        if x.ndim not in (2, 3) or x.shape[-1] != 3:
            raise SceneError(f"positions: {x.shape}; expected n × 3 or frames × n × 3")
        x = x[None] if x.ndim == 2 else x
        tri = array(triangles, (None, 3), "triangles", np.int32)
        if len(tri) and not 0 <= tri.min() <= tri.max() < x.shape[1]:
            raise SceneError(f"triangles: expected vertices 0 to {x.shape[1] - 1}")
        frames = x if len(x) > 1 else None
        return Meshes([Mesh("mesh", x[0], tri, frames, dt)], "mesh")
    if isinstance(what, (str, os.PathLike)):
        return open_source(os.fspath(what))
    if isinstance(what, Scene):
        what = World(what)
    if isinstance(what, World):
        return Live(what, paced=True)
    if isinstance(what, Mesh):
        return Meshes([what], what.name)
    if isinstance(what, dict) and all(isinstance(m, Mesh) for m in what.values()):
        return Meshes(list(what.values()), "meshes")
    x, tri = mesh_of(what, "view")
    return _source(x, tri, dt)


def view(
    what: Any,
    triangles: ArrayLike | None = None,
    *,
    dt: float = 1 / 60,
    play: bool = True,
    wait: bool | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
) -> Viewer:
    """Shows something on a page for a web browser (the extra `view`).

    A world is stepped while the page plays, and can be touched there: drag cloth or a
    body, change gravity, wind and fabric, restart. While the page is paused it follows
    the steps that the program makes.

    Args:
        what: a `World`, a `Scene`, a mesh as `Obstacle` takes it, meshes of
            `read_meshes`, the path of a run's folder, a scene or a mesh; or
            positions, [n, 3] m, or frames of these, [f, n, 3] m
        triangles: [k, 3], of positions
        dt: s between frames of positions
        play: whether it begins to play
        wait: whether to wait here until Ctrl-C; None: in a script, not in a notebook
        host: the address that the page is served on; beyond 127.0.0.1, this machine,
            it asks for the token that is in `Viewer.url`
        port: of the page, or another one where it is taken

    Returns:
        the page, whose address is printed where it waits
    """
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    make = need("drape.viewer.page", "the page", *PACKAGES).Page
    source = _source(what, triangles, dt)
    try:
        page = make(source, host, port, play=play)
    except BaseException:
        source.close()
        raise
    made = Viewer(page)
    if wait or (wait is None and not is_prompt()):
        print(f"{made.url} (Ctrl-C ends it)", flush=True)
        made.wait()
    return made
