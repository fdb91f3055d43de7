# SPDX-License-Identifier: Apache-2.0
"""Builds the package: the library and the tool by make, the extension by cffi.

$DRAPE_BUILD names the build folder (default: build/ of the checkout), $DRAPE_MAKE
further arguments of make, as GPU=yes, and $DRAPE_LOCAL the local version of the
wheel, as cu130 for one with the device's part by CUDA 13.0.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

import declare  # noqa: E402


def made() -> dict[str, list[str]]:
    """Makes what the extension is linked of, and returns its flags by kind."""
    build = os.environ.get("DRAPE_BUILD", "build")
    more = shlex.split(os.environ.get("DRAPE_MAKE", ""))
    make = ["make", "-s", "--no-print-directory", "-C", str(ROOT), *more]
    make += [f"BUILD={build}", "python-core"]
    lines = subprocess.run(make, check=True, stdout=subprocess.PIPE, text=True)
    words = [shlex.split(line) for line in lines.stdout.splitlines() if line]
    return {word[0]: [located(one) for one in word[1:]] for word in words}


def located(word: str) -> str:
    """Returns the path of a word that names a file of the checkout."""
    file = ROOT / word
    return str(file) if file.is_file() else word


class Build(build_ext):
    """Writes the extension's source and links it with what make has made."""

    def build_extension(self, ext: Extension) -> None:
        """Builds the one extension, and puts the tool beside it."""
        flags = made()
        source = Path(self.build_temp) / "_core.c"
        source.parent.mkdir(parents=True, exist_ok=True)
        declare.builder().emit_c_code(str(source))
        ext.sources.append(str(source))
        ext.extra_compile_args += flags["compile"]
        ext.extra_link_args += flags["link"]
        super().build_extension(ext)
        built = Path(self.get_ext_fullpath(ext.name)).parent
        package = HERE / "drape" if self.editable_mode else built
        for tool in flags["tool"]:
            (package / "bin").mkdir(exist_ok=True)
            shutil.copy2(tool, package / "bin/drape")
        share = package / "share/drape"  # where the tool looks for them
        share.mkdir(parents=True, exist_ok=True)
        for script in ("data.sh", "data.py", "lion.sh"):
            shutil.copy2(ROOT / "ci" / script, share / script)
        for folder in ("scenes", "patterns"):  # a scene names patterns beside it
            shutil.copytree(ROOT / "app" / folder, share / folder, dirs_exist_ok=True)


def urls() -> dict[str, str]:
    """Returns the project's addresses, by the repository's that CITATION.cff has."""
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    found = re.search(r'^repository-code: "?(\S+?)/?"?$', text, re.MULTILINE)
    if not found:
        return {}
    at = found[1]
    return {"Source": at, "Issues": f"{at}/issues"}


LOCAL = os.environ.get("DRAPE_LOCAL", "")

os.chdir(HERE)
setup(
    project_urls=urls(),
    version=declare.version() + (f"+{LOCAL}" if LOCAL else ""),
    ext_modules=[
        Extension(
            "drape._core",
            [
                "core/core.c",
                "core/bodies.c",
                "core/run.c",
                "core/tensor.c",
                "core/stream.c",
            ],
            depends=["declare.py", "core/core.h", "core/exports.map"],
            include_dirs=[str(ROOT), str(ROOT / "spec")],
            define_macros=[("_POSIX_C_SOURCE", "200809L")],
            extra_compile_args=["-std=c17", "-O2"],
            extra_link_args=[
                "-Wl,--wrap=complain,--defsym=__wrap_complain=core_complain",
                f"-Wl,--version-script={HERE / 'core/exports.map'}",
                "-Wl,-z,now",
            ],
            py_limited_api=True,
        )
    ],
    cmdclass={"build_ext": Build},
    options={"bdist_wheel": {"py_limited_api": "cp310"}},
)
