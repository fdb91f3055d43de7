#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Packs the add-on and the wheels that it needs into an extension for Blender.

usage: app/blender/pack.py OUT.zip WHEEL...
"""

from __future__ import annotations

import json
import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
FILES = [*sorted(p for p in HERE.glob("*.py") if p.name != "pack.py")]
FILES += [HERE.parent / "scene/fabrics.def"]


# What Blender calls the platforms that the last part of a wheel's name begins and
# ends with.
PLATFORMS = {
    ("manylinux", "x86_64"): "linux-x64",
    ("manylinux", "aarch64"): "linux-arm64",
    ("linux", "x86_64"): "linux-x64",
    ("macosx", "arm64"): "macos-arm64",
    ("macosx", "x86_64"): "macos-x64",
    ("win", "amd64"): "windows-x64",
    ("win", "arm64"): "windows-arm64",
}


def platforms(wheels: list[Path]) -> list[str]:
    """Returns the platforms that wheels are for; [] if for all. All packages that are
    for some have to be for the same ones."""
    of: dict[str, set[str]] = {}
    for wheel in wheels:
        for tag in wheel.stem.rpartition("-")[2].split("."):
            if tag == "any":
                continue
            known = {
                name
                for (begin, end), name in PLATFORMS.items()
                if tag.startswith(begin) and tag.endswith(end)
            }
            if not known:
                raise SystemExit(f"{wheel.name}: Blender knows no platform {tag}")
            of.setdefault(wheel.name.partition("-")[0], set()).update(known)
    for name, found in of.items():
        other, wanted = next(iter(of.items()))
        if found != wanted:
            raise SystemExit(
                f"{name} is for {' '.join(sorted(found))}; {other} for "
                f"{' '.join(sorted(wanted))}: expected wheels for the same platforms"
            )
    return sorted(set().union(*of.values()))


def pack(out: Path, wheels: list[Path]) -> None:
    """Writes the extension: files, wheels, and a manifest that names them."""
    names = [f"./wheels/{wheel.name}" for wheel in wheels]
    manifest = (HERE / "blender_manifest.toml").read_text(encoding="utf-8")
    head, table, rest = manifest.partition("[permissions]")
    listed = "".join(f'    "{name}",\n' for name in names)
    if on := platforms(wheels):
        head += f"platforms = {json.dumps(on)}\n"
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
