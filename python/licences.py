# SPDX-License-Identifier: Apache-2.0
"""Puts into a wheel the licences of the libraries that auditwheel has put there.

usage: licences.py WHEEL [NAME=FILE…]: FILE is the licence of a part that is linked
       statically, and is called NAME

auditwheel lists in the wheel the Debian package and the version that each library
is of. The package's copyright file has its licence, and names texts that Debian
keeps once for all packages. A library without one is an error.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

from auditwheel.wheeltools import InWheel

DOC, COMMON = Path("/usr/share/doc"), Path("/usr/share/common-licenses")
HEAD = """This wheel holds libraries of others, as Debian builds them, beside drape
itself (Apache-2.0: LICENSE). The folder of each package has its licence; texts that
several licences share are in the folder common. The sources are those of the Debian
packages of these versions.

"""


def packages(root: Path) -> dict[str, str]:
    """Returns the versions of the Debian packages whose files are in a wheel."""
    found: dict[str, str] = {}
    for file in root.glob("*.dist-info/sboms/auditwheel.cdx.json"):
        for part in json.loads(file.read_text(encoding="utf-8"))["components"]:
            if part["purl"].startswith("pkg:deb/"):
                found[part["name"]] = part["version"]
    return found


def texts(copyright_: str) -> set[str]:
    """Returns the names of Debian's common licences that a text refers to."""
    named = re.findall(rf"{COMMON}/([\w.+-]*\w)", copyright_)
    return {name for name in named if (COMMON / name).is_file()}


def add(root: Path, more: dict[str, Path]) -> None:
    """Writes the licences, and names them in the wheel's metadata."""
    [info] = root.glob("*.dist-info")
    folder = info / "licenses"
    libraries = list(root.glob("*.libs/*"))
    found = packages(root)
    if len(found) < len(libraries):
        raise SystemExit(f"{root}: {len(libraries)} libraries of {sorted(found)}")
    files = {f"{name}/copyright": DOC / name / "copyright" for name in found}
    files |= {f"{name}/copyright": path for name, path in more.items()}
    for name in sorted({n for path in files.values() for n in texts(path.read_text())}):
        files[f"common/{name}"] = COMMON / name
    for name, path in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(path.read_bytes())
    rows = [f"{name} {version}" for name, version in sorted(found.items())]
    rows += sorted(more)
    (folder / "BUNDLED").write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    metadata = info / "METADATA"
    head, blank, body = metadata.read_text(encoding="utf-8").partition("\n\n")
    lines = "".join(f"\nLicense-File: {name}" for name in ("BUNDLED", *files))
    metadata.write_text(head + lines + blank + body, encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Rewrites the wheel that the command line names."""
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    wheel = Path(arguments[0])
    more = dict(argument.split("=", 1) for argument in arguments[1:])
    with InWheel(wheel, wheel) as root:
        add(Path(root), {name: Path(path) for name, path in more.items()})
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
