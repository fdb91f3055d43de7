# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the documentation site. `make docs` builds it without a network."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import tables

project = "drape"
author = "the authors of drape"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = "drape"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
exclude_patterns = ["README.md"]
autodoc_member_order = "bysource"
autodoc_typehints = "description"
napoleon_google_docstring = True
napoleon_use_ivar = True
# Pages of the repository are included as they are; links of theirs lead to files
# that are not in the site.
suppress_warnings = ["myst.xref_missing", "myst.header"]

tables.write(Path(__file__).resolve().parent / "made")
