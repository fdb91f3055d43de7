# SPDX-License-Identifier: Apache-2.0
"""drape sweep: runs many variants of a scene, and says what became of them."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from drape.errors import Error, SceneError
from drape.export.console import (
    FAILED,
    FINDINGS,
    OK,
    USAGE,
    Parser,
    complain,
    say,
    whole,
)

from . import Sweep, grid, sample, sweep


def _value(word: str) -> Any:
    """Reads a value as JSON has it; another word is a text."""
    try:
        return json.loads(word)
    except ValueError:
        return word


def _key(text: str) -> tuple[str, str]:
    key, mark, rest = text.partition("=")
    if not (key and mark and rest):
        raise argparse.ArgumentTypeError(f"{text}: expected KEY=…")
    return key, rest


def values(text: str) -> tuple[str, list[Any]]:
    """Reads KEY=V,V…; one list of JSON, as KEY=[1, 2], is its values."""
    key, rest = _key(text)
    whole_ = _value(rest)
    if isinstance(whole_, list):
        return key, whole_
    return key, [_value(word) for word in rest.split(",")]


def span(text: str) -> tuple[str, tuple[float, float]]:
    """Reads KEY=LO..HI."""
    key, rest = _key(text)
    low, _, high = rest.partition("..")
    try:
        return key, (float(low), float(high))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text}: expected two numbers, KEY=LO..HI"
        ) from None


def _parser() -> Parser:
    parser = Parser(prog="drape sweep", description="Run many variants of a scene.")
    parser.add_argument("scene", metavar="SCENE.json")
    parser.add_argument("--out", required=True, metavar="DIR", help="or a URL")
    parser.add_argument(
        "--set",
        type=values,
        action="append",
        default=[],
        metavar="KEY=V,V…",
        help="each value of a key, as cloths.0.material.bend",
    )
    parser.add_argument(
        "--draw",
        type=span,
        action="append",
        default=[],
        metavar="KEY=LO..HI",
        help="at random between two numbers",
    )
    parser.add_argument("--count", type=whole, metavar="N", help="of draws")
    parser.add_argument("--seed", type=lambda text: whole(text, 0, 10**9), default=0)
    parser.add_argument("--frames", type=lambda text: whole(text, 0), metavar="N")
    parser.add_argument(
        "--every", type=lambda text: whole(text, 0), default=0, metavar="K"
    )
    parser.add_argument(
        "--sew", action="store_true", help="sew the garments first, as drape sew does"
    )
    parser.add_argument("--workers", type=whole, metavar="N")
    parser.add_argument("--on", choices=("local", "ray", "slurm"), default="local")
    parser.add_argument("--option", action="append", default=[], metavar="TEXT")
    return parser


def _run(given: argparse.Namespace) -> Sweep:
    """Runs what the command line says."""
    if bool(given.draw) != (given.count is not None):
        raise SceneError("--draw and --count go together")
    if given.draw and given.set:
        raise SceneError("expected --set, for all combinations, or --draw")
    scenes = (
        sample(given.scene, dict(given.draw), given.count, given.seed)
        if given.draw
        else grid(given.scene, dict(given.set))
    )

    def told(done: int, all_: int) -> None:
        if not given.quiet and sys.stderr.isatty():
            print(f"\r{done} of {all_}", end="", file=sys.stderr, flush=True)

    return sweep(
        scenes,
        given.out,
        on=given.on,
        frames=given.frames,
        every=given.every,
        sew=given.sew,
        workers=given.workers,
        options=given.option or None,
        progress=told,
    )


def main(argv: Sequence[str]) -> int:
    """`drape sweep`; returns the exit code."""
    given = _parser().parse_args(argv)
    try:
        done = _run(given)
    except SceneError as error:
        return complain(USAGE, f"sweep: {error}")
    except Error as error:
        return complain(FAILED, f"sweep: {error}")
    for row in done.failed:
        complain(OK, f"{row['label']}: failed: {row['error']}")
    if not given.quiet:
        words = f"{len(done.rows)} scenes, {len(done.failed)} failed"
        say(f"{done.path}: {words}, {done.reused} reused")
    return FINDINGS if done.failed else OK
