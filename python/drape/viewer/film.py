# SPDX-License-Identifier: Apache-2.0
"""The page's button that makes a film of a run, and gives it to the browser."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from drape.errors import Error
from drape.export.film import film
from drape.export.run import Run


def add_button(server: Any, run: Run) -> Any:
    """Adds the button, and returns it. Its film is by the scene's camera."""
    button = server.gui.add_button("Film")

    def make(event: Any) -> None:
        button.disabled, button.label = True, "Film is being made"
        try:
            with tempfile.TemporaryDirectory(prefix="drape-") as folder:
                made = film(run, Path(folder) / "film.mp4")
                event.client.send_file_download(
                    f"{run.scene}.mp4", made.read_bytes(), save_immediately=True
                )
        except Error as error:
            event.client.add_notification("There is no film", str(error))
        finally:
            button.disabled, button.label = False, "Film"

    button.on_click(make)
    return button
