# SPDX-License-Identifier: Apache-2.0
"""The library of bench/inside.c and bench/bare.c: the reference, in which the stages that
the bare scene does not use end the program, and steps that the library would refuse."""
import ctypes

from drape._core import ffi, lib

ENDS = ("stable", "diverged", "failed", "missed")


class Inside:
    """Has the functions of drape.h by their names, as `lib` of drape._core has."""

    def __init__(self, path):
        self.path, self.dll = path, ctypes.CDLL(path)

    def __getattr__(self, name):
        kind = ffi.typeof(ffi.addressof(lib, name))
        return ffi.cast(kind, ctypes.cast(self.dll[name], ctypes.c_void_p).value)

    def forced(self, sample, steps):
        """How a run by an explicit method ends, with one substep a step, whatever its
        limit: `stable`; `diverged`; `missed` if the state is not finite and no outcome
        said so; or `failed`."""
        s, kept = sample.settings, sample.fill()
        cloth = ctypes.c_void_p(int(ffi.cast("intptr_t", s.cloths)))
        end = self.dll.forced_run(cloth, s.integrator, ctypes.c_double(s.dt), steps)
        del kept
        return ENDS[end]
