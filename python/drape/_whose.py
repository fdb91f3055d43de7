# SPDX-License-Identifier: Apache-2.0
"""Whether this package is whole. PyPI's distribution `drape` is another project,
whose package has the same name: pip puts the files of one over those of the other
without a word. Importing this module refuses such a mixture. It imports nothing of
the package, as that may be either."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

NAME = "drape-cloth"  # of this distribution


def refuse_mixture() -> None:
    """Raises an ImportError where another distribution has its files in this folder."""
    try:
        other = distribution("drape")
    except PackageNotFoundError:
        return
    here = Path(__file__).resolve().parent
    if Path(str(other.locate_file("drape"))).resolve() == here:
        raise ImportError(
            f"{here}: two distributions have their files here: {NAME}, the cloth "
            f"simulator, and `drape` {other.version}, which on PyPI is another project "
            f"(it masks secrets). Type: pip uninstall -y drape {NAME}, and then "
            f"install the wheel of {NAME} again"
        )


refuse_mixture()
