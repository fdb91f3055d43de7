# SPDX-License-Identifier: Apache-2.0
"""drape view: serves a page that shows a run, or a scene while it is computed."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from drape._endings import PYTHONS, TOOLS
from drape.errors import Error, SceneError, need
from drape.export.console import FAILED, OK, USAGE, Parser, complain, port, say
from drape.export.run import RunError
from drape.meshes import read_meshes
from drape.viewer.live import Live
from drape.viewer.show import PACKAGES
from drape.viewer.source import Meshes, Recorded, Source


def open_source(name: str) -> Source:
    """A run's folder, a scene's file, or a file of meshes."""
    path = Path(name)
    if path.is_dir():
        return Recorded(path)
    if not path.is_file():
        raise RunError(f"{name}: expected the folder of a run, or a scene's file")
    if path.suffix.lower() in (*PYTHONS, *TOOLS):
        return Meshes(list(read_meshes(path).values()), path.name)
    return Live(path, paced=True)


def main(argv: Sequence[str] | None = None) -> int:
    """`drape view`; returns the exit code."""
    parser = Parser(
        prog="drape view", description="Show a run or a scene in a web browser."
    )
    parser.add_argument(
        "run",
        metavar="RUN|SCENE|MESH",
        help="a folder, a .json, or a file of meshes, as .ply, .npz, .usd",
    )
    parser.add_argument("--paused", action="store_true", help="do not begin to play")
    parser.add_argument(
        "--port",
        type=port,
        default=8080,
        metavar="N",
        help="8080, or another one where that is taken; 0: any that is free",
    )
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="NAME",
        help="the address that the page is served on, 0.0.0.0: all of this "
        "machine's; beyond this machine it asks for the token that is printed, and "
        "is not encrypted; default: 127.0.0.1, this machine alone",
    )
    given = parser.parse_args(argv)
    # what strangers send to the port is not for the terminal
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
    try:
        make = need("drape.viewer.page", "the page", *PACKAGES).Page
        source = open_source(given.run)
        page = make(source, given.host, given.port, play=not given.paused)
    except SceneError as error:
        return complain(USAGE, f"view: {error}")
    except Error as error:
        return complain(FAILED, f"view: {error}")
    try:
        say(f"{page.url} (Ctrl-C ends it)")
        page.serve()
    except KeyboardInterrupt:
        say("")
    except Error as error:
        return complain(FAILED, f"view: {error}")
    finally:
        page.close()
    return OK
