# SPDX-License-Identifier: Apache-2.0
"""What cffi is told of the C side, taken from the headers themselves.

A function that is added to spec/drape.h is thus callable from Python as
``lib.drape_…`` without another line here.
"""

from __future__ import annotations

import re
from pathlib import Path

import cffi

ROOT = Path(__file__).resolve().parent.parent

# The fields of app/scene/scene.h, and of look.h and cloth.h there, that Python reads or
# sets; "..." lets the compiler place them.
SCENE = """
struct look { double colour[3]; ...; };
struct camera { double eye[3], target[3]; double fov; ...; };
struct scene {
    drape_def def;
    char *name;
    int frames;
    int steps_per_frame;
    double memory;
    struct camera camera;
    char **cloth_name, **obstacle_name, **motion_name;
    struct look *cloth_look, *obstacle_look;
    int status;
    ...;
};
struct cloth_panel { drape_panel panel; double at[2]; ...; };
"""

# Functions of Python that the library calls.
CALLBACKS = """
extern "Python" {
    void core_log(void *user, const char *line);
    void core_trace(void *user, int64_t step, const char *stage,
                    uint64_t digest, double seconds);
    int core_write(void *user, const void *data, size_t bytes);
    int core_read_bytes(void *user, void *data, size_t bytes);
}
"""

SOURCE = '#include "python/core/core.h"\n'


def plain(text: str) -> str:
    """Returns a header's declarations, without comments and directives."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", text, flags=re.DOTALL)
    return re.sub(r"^[ \t]*#[^\n]*(?:\\\n[^\n]*)*", "", text, flags=re.MULTILINE)


def header() -> str:
    """Returns the text of spec/drape.h."""
    return (ROOT / "spec/drape.h").read_text(encoding="utf-8")


def version() -> str:
    """Returns DRAPE_VERSION."""
    found = re.search(r'#define DRAPE_VERSION "(.*)"', header())
    assert found, "spec/drape.h has no DRAPE_VERSION"
    return found[1]


def builder() -> cffi.FFI:
    """Returns the declarations, from which cffi writes the extension's source."""
    core = (ROOT / "python/core/core.h").read_text(encoding="utf-8")
    core = core.split("/* CORE_BEGIN */")[1].split("/* CORE_END */")[0]
    ffi = cffi.FFI()
    ffi.cdef(plain(header()) + SCENE + plain(core) + CALLBACKS)
    ffi.set_source("drape._core", SOURCE, py_limited_api=True)
    return ffi
