#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Packs the add-on and the wheels that it needs into an extension for Blender.

usage: app/blender/pack.py OUT.zip WHEEL...
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FILES = [*sorted(p for p in HERE.glob("*.py") if p.name != "pack.py")]
FILES += [HERE.parent / "scene/fabrics.def"]


def pack(out: Path, wheels: list[Path]) -> None:
    """Writes the extension: files, wheels, and a manifest that names them."""
    names = [f"./wheels/{wheel.name}" for wheel in wheels]
    manifest = (HERE / "blender_manifest.toml").read_text(encoding="utf-8")
    head, table, rest = manifest.partition("[permissions]")
    listed = "".join(f'    "{name}",\n' for name in names)
    head += f"wheels = [\n{listed}]\n\n"
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", head + table + rest)
        for file in FILES:
            archive.write(file, file.name)
        for wheel, name in zip(wheels, names, strict=True):
            archive.write(wheel, name.removeprefix("./"))


def main() -> int:
    """Packs what the command line names."""
    if len(sys.argv) < 3 or not all(Path(a).is_file() for a in sys.argv[2:]):
        print("usage: app/blender/pack.py OUT.zip WHEEL...", file=sys.stderr)
        return 2
    pack(Path(sys.argv[1]), [Path(a) for a in sys.argv[2:]])
    return 0


if __name__ == "__main__":
    sys.exit(main())
