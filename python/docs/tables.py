# SPDX-License-Identifier: Apache-2.0
"""Writes the pages that come from the code's own tables: the commands of the
tool with their help, and the keys of a scene with their types and ranges; and
those of the notebooks."""

from __future__ import annotations

import json
import re
from pathlib import Path

import drape

ROOT = Path(__file__).resolve().parents[2]
# The objects of a scene: their heading, the file and the mark of their table.
OBJECTS = [
    ("The scene", "scene.c", "SCENE("),
    ("wind", "scene.c", "WIND("),
    ("camera", "scene.c", "struct camera,"),
    ("A motion", "motion.c", "struct motion,"),
    ("A keyframe", "motion.c", "struct key,"),
    ("look", "look.c", "struct look,"),
    ("A cloth", "cloth.c", "CLOTH("),
    ("panel", "panel.c", "struct panel_key,"),
    ("start", "cloth.c", "START("),
    ("A region of holes or cuts", "cloth.c", "struct region,"),
    ("A pin", "cloth.c", "struct pin,"),
    ("material", "cloth.c", "MATERIAL("),
    ("An obstacle", "obstacle.c", "O("),
    ("frames of an obstacle", "sequence.c", "struct sequence,"),
    ("bend of a limb", "limb.c", "struct limb_key,"),
]
KINDS = {
    "NUMBER": "number",
    "INTEGER": "whole number",
    "BOOLEAN": "true or false",
    "VECTOR": "numbers",
    "TEXT": "text",
    "CHOICE": "one of",
    "NESTED": "see below",
}
ROW = re.compile(
    r'([A-Z]+)_KEY\(\s*"(\w+)",([^{}]*?)\),?\s*(?=[A-Z]+_KEY|/\*|$)', re.DOTALL
)
# What says more than the kind of a nested key: the reader of its values.
NESTED = {
    "read_fabric": "a fabric's name",
    "read_stretch": "number, or an object of measured tensions",
    "read_limit": "number or 3 numbers",
    "read_motion_name": "a motion's name",
    "read_times": "a list of numbers, ascending",
}


def tool() -> str:
    """Returns the page of the tool's commands."""
    listed = drape.tool.call("help")
    names = re.findall(r"^  ([\w-]+) ", listed, re.MULTILINE)
    parts = ["# The tool\n", f"```text\n{listed}```\n"]
    for name in names:
        text = drape.tool.call("help", name)
        parts.append(f"## {name}\n\n```text\n{text}```\n")
    return "\n".join(parts)


def c_api() -> str:
    """Returns the page of the library's header: each declaration with its comment."""
    text = (ROOT / "spec/drape.h").read_text(encoding="utf-8")
    text = re.sub(r"(?<![\w/])(\w+/\w+\.md)", r"spec/\1", text)
    text = text[
        text.index("/* What a call returns") : text.index("#ifdef __cplusplus\n}")
    ]
    parts = ["# The C API\n", "This is `drape.h`, the whole of it.\n"]
    # a paragraph ends at an empty line outside of braces
    for each in re.split(r"\n\n(?=/\*|[a-z#])", text):
        found = re.match(r"\s*/\*(.*?)\*/\s*(.*)", each, re.DOTALL)
        prose, code = (found[1], found[2]) if found else ("", each.strip())
        if not code or code.startswith("#"):
            continue
        names = re.findall(
            r"\b(drape_\w+)\(", re.sub(r"/\*.*?\*/", "", code, flags=re.S)
        )
        name = re.match(r"(?:typedef )?(struct|enum) (\w+)", code)
        if name:
            names = [f"{name[1]} {name[2]}" if name[1] == "enum" else name[2]]
        words = re.sub(r"\s*\n \* ?", " ", prose).strip().replace("*", "\\*")
        parts.append(
            f"## {', '.join(dict.fromkeys(names)) or 'Constants'}\n\n{words}\n"
        )
        parts.append(f"```c\n{code}\n```\n")
    return "\n".join(parts)


def choices(text: str, name: str) -> str:
    """Returns the values of a table of texts."""
    found = re.search(rf"{name}\[\] = \{{(.*?)NULL", text, re.DOTALL)
    values = re.findall(r'"([\w-]+)"', found[1]) if found else []
    return ", ".join(f"`{value}`" for value in values)


def keys(file: str, mark: str) -> list[tuple[str, str, str]]:
    """Returns (key, type, range) of the rows of a table of the scene's reader."""
    text = (ROOT / "app/scene" / file).read_text(encoding="utf-8")
    tables = re.findall(r"json_key \w+\[\] = \{(.*?)\{0\}", text, re.DOTALL)
    table = next(each for each in tables if mark in each)
    # a macro of the file's own that stands for a number of its argument's name
    table = re.sub(r"MATERIAL\((\w+), ", r'NUMBER_KEY("\1", , ', table)
    rows = []
    for kind, key, rest in ROW.findall(table):
        words = [word.strip() for word in rest.split(",")]
        numbers = [word for word in words if re.fullmatch(r"-?[\d.]+(e-?\d+)?", word)]
        limits = f"{numbers[0]} … {numbers[1]}" if len(numbers) > 1 else ""
        what = KINDS[kind]
        if kind == "VECTOR":
            what = f"{numbers[2]} numbers"
        if kind == "NESTED":
            what = NESTED.get(words[-1], what)
        if kind == "CHOICE":
            limits = choices(text, words[-1])
        rows.append((key, what, limits))
    if not rows:
        raise ValueError(f"app/scene/{file}: cannot read the table of keys of {mark}")
    return rows


def scene() -> str:
    """Returns the page of a scene's keys."""
    parts = [
        "# Keys of a scene\n",
        "These tables are made of those that the reader itself checks a scene by; "
        "[Scenes](../scenes.md) says what each key means.\n",
    ]
    for heading, file, mark in OBJECTS:
        parts.append(f"## {heading}\n\n| key | type | range |\n| --- | --- | --- |")
        parts += [
            f"| `{k}` | {kind} | {limits} |" for k, kind, limits in keys(file, mark)
        ]
        parts.append("")
    return "\n".join(parts)


def notebook(path: Path) -> str:
    """Returns a notebook as a page. A cell that needs something says what."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        tags = cell["metadata"].get("tags", ())
        if cell["cell_type"] == "code":
            needs = f":caption: needs {', '.join(tags)}\n" if tags else ""
            text = f"```{{code-block}} python\n{needs}\n{text}\n```"
        parts.append(text)
    return "\n\n".join(parts) + f"\n\nThe notebook is `{path.name}`.\n"


def write(folder: Path) -> None:
    """Writes the pages."""
    folder.mkdir(exist_ok=True)
    (folder / "tool.md").write_text(tool(), encoding="utf-8")
    (folder / "capi.md").write_text(c_api(), encoding="utf-8")
    (folder / "keys.md").write_text(scene(), encoding="utf-8")
    for path in (ROOT / "python/docs/tutorials").glob("*.ipynb"):
        page = folder / f"{path.stem}.md"
        page.write_text(notebook(path), encoding="utf-8")
    fabrics = drape.tool.call("materials")
    text = f"# Fabrics\n\n```text\n{fabrics}```\n"
    (folder / "fabrics.md").write_text(text, encoding="utf-8")
