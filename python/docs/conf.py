# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the documentation site. `make docs` builds it without a network."""

import sys
from pathlib import Path
from typing import Any

from docutils import nodes

sys.path.insert(0, str(Path(__file__).resolve().parent))

import tables

project = "drape"
author = copyright = "the authors of drape"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = "drape"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
exclude_patterns = ["README.md"]
autodoc_member_order = "bysource"
autoclass_content = "both"
default_role = "code"
python_maximum_signature_line_length = 80
napoleon_google_docstring = True
napoleon_use_ivar = True
# Pages of the repository are included as they are; links of theirs lead to files
# that are not in the site.
suppress_warnings = ["myst.xref_missing", "myst.header"]


def drop_dead_links(_app: Any, tree: Any, _name: str) -> None:
    """Makes a link to a file that is not in the site its text."""
    for node in list(tree.findall(nodes.reference)):
        if "/" in node.get("refid", "") or node.get("refid", "").endswith(".md"):
            node.replace_self(node.children)


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("doctree-resolved", drop_dead_links)


tables.write(Path(__file__).resolve().parent / "made")
