# SPDX-License-Identifier: Apache-2.0
"""What a call costs, and how large the extension is, by cffi and by nanobind.

usage: binding.py FOLDER, where both are installed; builds two extensions there.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import timeit
import zlib
from pathlib import Path

import cffi
import nanobind

C = """#include <stdint.h>
typedef struct { double d[24]; int64_t n[12]; } report;
static int64_t size(const void *w) { return w ? 1 : -1; }
static int step(void *w, report *r) { if (r) r->n[0]++; return w ? 0 : -1; }
"""
CDEF = """typedef struct { double d[24]; int64_t n[12]; } report;
int64_t size(const void *w); int step(void *w, report *r);"""
CPP = """#include <nanobind/nanobind.h>
struct report { double d[24]; int64_t n[12]; };
struct world { int64_t size() const { return 1; }
    int step(report &r) { r.n[0]++; return 0; } };
NB_MODULE(by_nanobind, m) {
    nanobind::class_<report>(m, "report").def(nanobind::init<>());
    nanobind::class_<world>(m, "world").def(nanobind::init<>())
        .def("size", &world::size)
        .def("step", &world::step,
             nanobind::call_guard<nanobind::gil_scoped_release>()); }
"""


def build(folder: Path) -> dict[str, Path]:
    """Builds both extensions, and returns their files."""
    ffi = cffi.FFI()
    ffi.cdef(CDEF)
    ffi.set_source("by_cffi", C, extra_compile_args=["-O2"])
    one = Path(ffi.compile(str(folder)))
    (folder / "by_nanobind.cpp").write_text(CPP)
    root = Path(nanobind.include_dir()).parent
    two = folder / "by_nanobind.so"
    command = ["g++", "-O2", "-std=c++17", "-fPIC", "-shared", "-DNDEBUG"]
    command += ["-fvisibility=hidden", f"-I{nanobind.include_dir()}"]
    command += [f"-I{root}/ext/robin_map/include"]
    command += [f"-I{sysconfig.get_path('include')}", f"{folder}/by_nanobind.cpp"]
    command += [f"{nanobind.source_dir()}/nb_combined.cpp", "-o", str(two)]
    subprocess.run(command, check=True)
    subprocess.run(["strip", one, two], check=True)
    return {"cffi": one, "nanobind": two}


def main(folder: Path) -> None:
    """Prints a row for each binding."""
    files = build(folder)
    sys.path.insert(0, str(folder))
    import by_cffi
    import by_nanobind

    pointer, report = by_cffi.ffi.cast("void *", 1), by_cffi.ffi.new("report *")
    world, other = by_nanobind.world(), by_nanobind.report()
    calls = {
        "cffi": (
            lambda: by_cffi.lib.size(pointer),
            lambda: by_cffi.lib.step(pointer, report),
        ),
        "nanobind": (lambda: world.size(), lambda: world.step(other)),
    }
    for name, file in files.items():
        times = [min(timeit.repeat(f, number=10**6)) * 1e3 for f in calls[name]]
        size = len(zlib.compress(file.read_bytes())) / 1e3
        print(
            f"{name:9} {times[0]:4.0f} ns a call, {times[1]:4.0f} ns with a report, "
            f"{size:4.0f} kB compressed"
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
