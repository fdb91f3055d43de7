# SPDX-License-Identifier: Apache-2.0
"""The page of `drape view` in headless Chromium, by what its pixels show.

DRAPE_SHOTS=DIR keeps the pictures.
"""

from __future__ import annotations

import io
import json
import os
import shutil
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import need, program

import drape
from apps.runs import STILL, make, moving
from drape.export import mesh
from drape.viewer.live import GRIP, Live
from drape.viewer.source import Contacts, Recorded, Source, step_words

need("viser")
need("pygltflib")
playwright = need("playwright.sync_api")
from drape.viewer.cli import main, open_source  # noqa: E402
from drape.viewer.page import Page  # noqa: E402
from drape.viewer.stage import display  # noqa: E402

# Until what a test waits for has failed. A picture that Chromium draws in software
# takes a second, and half a minute where others use the processors.
SECONDS = 120


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium that draws in software."""
    path = program("chromium")
    flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with playwright.sync_playwright() as p:
        chromium = p.chromium.launch(executable_path=path, args=flags)
        yield chromium
        chromium.close()


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


class View:
    """A page that is served, and the browser's window on it."""

    def __init__(self, page: Page, window: Any) -> None:
        self.page, self.window = page, window
        window.set_default_timeout(1000 * SECONDS)
        self.errors: list[str] = []
        window.on("pageerror", lambda e: self.errors.append(str(e)))
        # viser draws with fewer pixels where it is slow, which is another picture
        window.goto(f"http://127.0.0.1:{page.port}/?fixedDpr=1")
        window.get_by_text("frame", exact=False).first.wait_for()
        note = window.get_by_text("Software WebGL rendering detected")
        if note.count():  # it covers a part of the picture
            window.locator(".mantine-Notification-closeButton").first.click()

    def pixels(self) -> np.ndarray:
        """The picture [height, width, 3], left of the controls."""
        image = need("PIL.Image")
        data = image.open(io.BytesIO(self.window.screenshot())).convert("RGB")
        return np.array(data).astype(int)[:, :460]

    def until(self, good: Callable[[np.ndarray], bool], name: str) -> np.ndarray:
        """Waits for a picture with a property, keeps it, and returns it."""
        end = time.monotonic() + SECONDS
        while True:
            found = self.pixels()
            if good(found):
                break
            if time.monotonic() > end:
                self.keep(f"failed {name}")
                pytest.fail(f"never shown: {name}")
            time.sleep(0.1)
        self.keep(name)
        return found

    def still(self) -> np.ndarray:
        """The picture when it does not change any more."""
        before = self.pixels()
        while not np.array_equal(before, after := self.pixels()):
            before = after
        return after

    def keep(self, name: str) -> None:
        """Keeps the picture, if anybody asked for it."""
        if folder := os.environ.get("DRAPE_SHOTS"):
            self.window.screenshot(path=Path(folder) / f"{name}.png")


@contextmanager
def shown(source: Source, browser: Any, play: bool = False) -> Iterator[View]:
    """Serves a source, and opens its page."""
    page = Page(source, "127.0.0.1", free_port(), play=play)
    page.server.scene.configure_default_lights(cast_shadow=False)  # slow here
    thread = threading.Thread(target=page.serve)
    thread.start()
    window = browser.new_page(viewport={"width": 800, "height": 400})
    try:
        view = View(page, window)
        yield view
        assert not view.errors
    finally:
        window.close()
        page.close()
        thread.join()


def wait_until(good: Callable[[], bool]) -> None:
    """Waits until something is so."""
    end = time.monotonic() + SECONDS
    while not good():
        assert time.monotonic() < end
        time.sleep(0.05)


def box(window: Any, name: str) -> Any:
    """A checkbox of the controls."""
    return window.get_by_role("checkbox", name=name)


def red(p: np.ndarray) -> int:
    """Number of pixels of the first cloth's colour."""
    return int(((p[..., 0] > 2 * p[..., 1]) & (p[..., 0] > 2 * p[..., 2])).sum())


def dark(p: np.ndarray) -> int:
    """Number of pixels of wires."""
    return int((p.max(-1) < 60).sum())


def differ(a: np.ndarray, b: np.ndarray) -> int:
    """Number of blocks of 8 × 8 pixels whose means differ."""
    blocks = (a - b)[: len(a) // 8 * 8, : a.shape[1] // 8 * 8]
    means = blocks.reshape(len(a) // 8, 8, -1, 8, 3).mean((1, 3))
    return int((np.abs(means).max(-1) > 16).sum())


def test_a_recorded_run(still: Path, browser: Any) -> None:
    with shown(Recorded(still), browser) as view:
        view.until(lambda p: red(p) > 2000, "start")
        window = view.window
        assert window.get_by_text("frame 0").is_visible()

        first = view.still()
        slider = window.get_by_role("slider").first
        slider.focus()
        slider.press("End")
        window.get_by_text("frame 8").wait_for()
        assert window.get_by_text("contacts,").is_visible()
        view.until(lambda p: differ(p, first) > 10, "scrubbed")

        plain = view.still()
        box(window, "Wires").check()
        view.until(lambda p: dark(p) > dark(plain) + 100, "wires")
        box(window, "Wires").uncheck()
        view.until(lambda p: dark(p) < dark(plain) + 50, "no wires")

        assert not view.page.limit.visible
        view.page.colour.value = "strain"
        view.window.get_by_text("stretched 2 %").wait_for()
        view.until(lambda p: red(p) < red(plain) / 2, "strain")
        view.page.colour.value = "cloth"
        view.until(lambda p: red(p) > 0.9 * red(plain), "cloth again")

        window.mouse.move(250, 380)
        window.mouse.down()
        window.mouse.move(350, 330, steps=5)
        window.mouse.up()
        turned = view.until(lambda p: differ(p, plain) > 30, "orbited")
        assert red(turned) > 1000
        assert not box(window, "Contacts").is_enabled()
        assert window.get_by_text("drape run --contacts").is_visible()


def test_play_and_pause(still: Path, browser: Any) -> None:
    with shown(Recorded(still), browser) as view:
        window, seen = view.window, set()
        view.page.speed.value = 0.05
        window.get_by_role("button", name="Play").click()
        end = time.monotonic() + SECONDS
        while len(seen) < 4 and time.monotonic() < end:
            seen.add(view.page.shown)
            time.sleep(0.05)
        assert len(seen) >= 4
        window.get_by_role("button", name="Pause").click()
        window.get_by_role("button", name="Play").wait_for()
        time.sleep(0.2)
        frame = view.page.shown
        time.sleep(1)
        assert view.page.shown == frame


def test_a_run_that_goes_on_is_followed(
    still: Path, tmp_path: Path, browser: Any
) -> None:
    folder = tmp_path / "run"
    shutil.copytree(still, folder)
    later = folder / "frames" / "cloth_0008.ply"
    later.rename(tmp_path / "later.ply")
    report = json.loads((folder / "report.json").read_text())
    whole = json.dumps(report)
    report.update(end="unfinished", steps=[])
    (folder / "report.json").write_text(json.dumps(report))
    with shown(Recorded(folder), browser, play=True) as view:
        view.window.get_by_text("frame 7").wait_for()
        (tmp_path / "later.ply").rename(later)
        view.window.get_by_text("frame 8").wait_for()
        (folder / "report.json").write_text(whole)
        view.window.get_by_text("frame 3").wait_for()  # it begins again


def test_a_scene_is_shown_while_it_is_computed(tmp_path: Path, browser: Any) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(moving()))
    with shown(open_source(str(file)), browser, play=True) as view:
        view.until(lambda p: red(p) > 2000, "live")
        view.window.get_by_text("frame 8").wait_for()
        assert view.page.live is not None and view.page.live.paced


def test_keys_loop_and_steps(still: Path, browser: Any) -> None:
    with shown(Recorded(still), browser) as view:
        window, page = view.window, view.page
        view.until(lambda p: red(p) > 2000, "keys")
        window.mouse.click(250, 390)
        window.keyboard.press("ArrowRight")
        window.get_by_text("frame 1", exact=True).wait_for()
        window.get_by_role("button", name="last").click()
        window.get_by_text("frame 8").wait_for()
        window.get_by_role("button", name="back").click()
        window.get_by_text("frame 7").wait_for()
        page.loop.value = False
        window.mouse.click(250, 390)
        window.keyboard.press("Space")
        window.get_by_text("frame 8").wait_for()
        window.get_by_role("button", name="Play").wait_for()  # the end stops it
        assert not page.playing
        page.loop.value = True
        window.keyboard.press("Space")
        window.get_by_text("frame 0").wait_for()
        page.colour.value = "cloth"
        window.keyboard.press("c")
        window.get_by_text("stretched 2 %").wait_for()
        window.get_by_text("Keys").click()
        window.get_by_text("see all").wait_for()


def near(p: np.ndarray, rgb: tuple[int, ...]) -> int:
    """Number of pixels of about a colour."""
    return int((np.abs(p - np.array(rgb)).max(-1) < 30).sum())


def test_colours_are_those_that_are_asked_for(sewn: Path, browser: Any) -> None:
    """In light neither paler nor darker; lines are in no light at all."""
    source = Recorded(sewn)
    assert source.pattern
    with shown(source, browser) as view:
        front = display(mesh.colour(source.bodies[0], 0))
        view.until(lambda p: near(p, front) > 1000, "front")
        long = [seam.colour for seam in source.pattern.seams[:4]]
        view.until(lambda p: min(near(p, rgb) for rgb in long) > 40, "seams")


def test_the_pattern_of_a_garment(sewn: Path, browser: Any) -> None:
    with shown(Recorded(sewn), browser) as view:
        window, page = view.window, view.page
        both = view.still()
        window.mouse.click(20, 390)
        window.keyboard.press("p")
        wait_until(lambda: not page.pattern.value)
        view.until(lambda p: differ(p, both) > 60, "no pattern")
        alone = view.still()
        window.keyboard.press("f")  # without the pattern all is nearer
        view.until(lambda p: differ(p, alone) > 60, "garment alone")
        window.get_by_text("Seams", exact=True).click()
        window.get_by_text("front 1 to back 7, closed in step").wait_for()


def test_controls_do_not_cover_the_picture(still: Path, browser: Any) -> None:
    with shown(Recorded(still), browser) as view:
        canvas = view.window.locator("canvas").first.bounding_box()
        play = view.window.get_by_role("button", name="Play").bounding_box()
        assert canvas["x"] + canvas["width"] <= play["x"]


LIVE = {
    "cloths": [{"particles": [15, 15], "pins": [{"edge": "v0"}]}],
    "camera": {"eye": [0.4, -0.2, 2.2], "target": [0.4, -0.4, 0]},
}


def test_a_live_world_is_touched(browser: Any) -> None:
    world = drape.World(LIVE)
    source = Live(world, paced=True)
    with shown(source, browser, play=True) as view:
        window, page = view.window, view.page
        view.until(lambda p: red(p) > 2000 and world.steps > 20, "hung")
        picture = view.pixels()
        is_red = picture[..., 0] > 2 * picture[..., 1]
        y, x = (int(np.median(each)) for each in np.nonzero(is_red))
        assert red(picture[y - 4 : y + 4, x - 4 : x + 4]) > 40
        window.mouse.move(x, y)
        window.mouse.down()
        window.mouse.move(x - 20, y - 20, steps=4)
        window.mouse.move(x - 90, y - 60, steps=4)
        wait_until(lambda: GRIP in world.pins)
        group = world.pins[GRIP]
        assert 4 <= len(group.particles) <= 13
        before = world.read()[0][group.particles]
        window.mouse.move(x - 140, y - 90, steps=4)
        wait_until(lambda: (world.read()[0][group.particles] - before)[0, 0] < -0.05)
        window.mouse.up()
        wait_until(lambda: GRIP not in world.pins)
        # a hand that moves far within a step, as on a busy machine, may need more
        wait_until(lambda: world.report is not None and not world.report.outcome)

        page.touch.gravity.value = (0.0, 9.81, 0.0)
        wait_until(lambda: world.read()[0][:, 1].max() > 0.2)
        page.touch.fabric.value = "denim"
        page.touch.wind.value = (0.0, 0.0, 5.0)
        wait_until(lambda: "wind" in {row.stage for row in world.plan() if row.on})
        steps = world.steps
        window.mouse.click(20, 390)
        window.keyboard.press("r")
        wait_until(lambda: world.steps < steps)
        assert world.gravity.tolist() == [0, -9.81, 0]
        assert tuple(page.touch.gravity.value) == (0, -9.81, 0)

        window.get_by_role("button", name="Pause").click()
        wait_until(lambda: not page.playing)
        time.sleep(0.5)
        window.get_by_role("button", name="last", exact=True).click()
        wait_until(lambda: page.shown == source.frames()[-1])
        steps = world.steps
        window.get_by_role("button", name="on", exact=True).click()
        wait_until(lambda: world.steps == steps + 1)
        world.step(2)  # the page follows the program
        wait_until(lambda: page.shown == source.frames()[-1])


def test_what_is_refused_is_told(browser: Any) -> None:
    keys = {"pins": [{"edge": "v0", "motion": "go"}], "particles": [9, 9]}
    motion = {"name": "go", "keys": [{"time": 0}]}
    world = drape.World({"cloths": [keys], "motions": [motion]})
    source = Live(world, paced=True)
    with shown(source, browser) as view:
        source.grab(0, [0.0, 0.0, 0.0])
        wait_until(lambda: "follow a motion" in source.words(0))
        view.page._dirty.set()
        view.window.get_by_text("its pins follow a motion").wait_for()


def test_view_of_a_world_and_of_a_mesh() -> None:
    world = drape.World({"cloths": [{"particles": [9, 9]}]})
    with world.view(wait=False, play=False, port=free_port()) as viewer:
        assert viewer.url in repr(viewer) and "<iframe" in viewer._repr_html_()
        page = viewer._page
        world.step(3)
        wait_until(lambda: page.shown == 1)
    world.step()
    x = np.stack([world.positions[:81], world.positions[:81] + 1])
    with drape.view(x, world.triangles, wait=False, port=free_port()) as viewer:
        wait_until(lambda: viewer._page.shown == 1)
    mesh = drape.Mesh("a", x[0], np.asarray(world.triangles))
    for what in (mesh, {"a": mesh}, (x[0], world.triangles)):
        with drape.view(what, wait=False, port=free_port()) as viewer:
            assert len(viewer._page.source.bodies) == 1
    with pytest.raises(drape.SceneError, match=r"positions: \(2, 3, 2\); expected n"):
        drape.view(np.zeros((2, 3, 2)), [[0, 1, 2]], wait=False)
    with pytest.raises(drape.SceneError, match="triangles: expected vertices 0 to 2"):
        drape.view(np.zeros((3, 3)), [[0, 1, 3]], wait=False)
    with pytest.raises(drape.SceneError, match="is no mesh"):
        drape.view(3, wait=False)


def test_a_token_opens_the_page(still: Path, browser: Any) -> None:
    page = Page(Recorded(still), "0.0.0.0", free_port())
    thread = threading.Thread(target=page.serve)
    thread.start()
    window = browser.new_page()
    try:
        here = f"http://127.0.0.1:{page.port}/"
        assert window.goto(here).status == 403
        window.goto(f"{here}?token={page.gate.token}")
        window.get_by_text("frame", exact=False).first.wait_for(timeout=1000 * SECONDS)
        assert window.url == here
    finally:
        window.close()
        page.close()
        thread.join()


def test_the_words_of_a_step() -> None:
    words = step_words("clean", 0, 1, 12)
    assert words == "clean, 0 contacts, 1 round, 12 iterations"


class Touching(Recorded):
    """A run with contacts that a test can recognise."""

    def contacts(self, frame: int) -> Contacts:
        """One contact above the cloths, with an impulse to the left, after frame 0."""
        count = min(frame, 1)
        points = np.array([[0, 0.43, 0]] * count, np.float32).reshape(-1, 3)
        return Contacts(points, np.full_like(points, -0.36) * [1, 0, 0])


def test_contacts_and_impulses(still: Path, browser: Any) -> None:
    with shown(Touching(still), browser) as view:
        view.page.frame.value = 1
        contacts = box(view.window, "Contacts")
        view.until(lambda p: red(p) > 2000, "no contacts")
        bare = view.still()
        contacts.check()
        view.until(lambda p: differ(p, bare) > 20, "contacts")
        contacts.uncheck()
        view.until(lambda p: differ(p, bare) < 5, "contacts off")


def test_a_film_of_the_run(still: Path, browser: Any, tmp_path: Path) -> None:
    program("ffmpeg")
    with shown(Recorded(still), browser) as view:
        with view.window.expect_download(timeout=1000 * SECONDS) as found:
            view.window.get_by_role("button", name="Film").click()
        found.value.save_as(tmp_path / "film.mp4")
        assert found.value.suggested_filename == "two sheets.mp4"
        assert (tmp_path / "film.mp4").read_bytes()[4:8] == b"ftyp"
        view.window.get_by_role("button", name="Film", exact=True).wait_for()


def test_recorded_contacts_and_impulses(tmp_path: Path, browser: Any) -> None:
    folder = make(tmp_path / "run", STILL, "--contacts")
    with shown(Recorded(folder), browser) as view:
        view.page.frame.value = 8
        contacts = box(view.window, "Contacts")
        view.until(lambda p: red(p) > 2000, "no contacts recorded")
        bare = view.still()
        contacts.check()
        view.until(lambda p: differ(p, bare) > 1, "contacts recorded")
        view.window.get_by_text("N and more").wait_for()
        points = view.still()
        view.page.arrows.value = 60.0
        view.until(lambda p: differ(p, points) > 0.5, "forces recorded")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "nowhere"),
        (["."], "report.json"),
        ([".", "--port", "none"], "--port"),
        ([".", "--port", "65536"], "from 0 to 65535"),
        ([], "RUN"),
    ],
)
def test_a_wrong_command_line_is_one_line(
    arguments: list[str],
    words: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        code = main(arguments)
    except SystemExit as end:
        code = int(str(end.code))
    out, err = capsys.readouterr()
    assert code == 2 and not out and err.count("\n") == 1 and words in err
