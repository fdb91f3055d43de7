# SPDX-License-Identifier: Apache-2.0
"""A world's arrays where they lie, on the host or a device, without a copy."""

from __future__ import annotations

import ctypes
import warnings
from typing import Any

import numpy as np

from ._core import ffi, lib
from ._define import Handle
from .errors import DeviceError, check

CPU, CUDA = 1, 2  # device types of DLPack
FLOAT = 2  # type code of DLPack

_capsule = ctypes.pythonapi.PyCapsule_New
_capsule.restype = ctypes.py_object
_capsule.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)


def address(pointer: Any) -> int:
    """Returns a pointer of C's as a number."""
    return int(ffi.cast("uintptr_t", pointer))


class SharedArray:
    """The positions or the velocities of a world, shared without a copy.

    It is read-only, of shape [vertices, 3], in m or m/s. On the host
    ``numpy.asarray`` takes it; on a device whatever knows DLPack or
    ``__cuda_array_interface__`` does: ``torch.from_dlpack``,
    ``cupy.from_dlpack``, ``warp.array``. Each such call gives the state as it
    is then. What it returns is valid until the world's next step, which writes
    the next state elsewhere: call again after each step. When bodies come or go
    its memory is released: do not read it any more.

    A consumer that DLPack before version 1 cannot tell that the array is read-only
    is refused on the host, where it takes a copy, ``numpy.array``, and warned of on a
    device. torch has no read-only tensors: what is written to one that shares these
    bytes changes the world without its knowledge. Write to a copy, and give that to
    `World.set_positions`.

    On a device the array is complete in the order of the world's stream
    (`World.stream`). DLPack makes the caller's stream wait for it; whoever
    reads ``__cuda_array_interface__`` is told the stream. Before the next step,
    call `World.wait_for` with a stream that still reads the array.
    """

    def __init__(self, handle: Handle, field: str) -> None:
        """Made by a world; field is that of a drape_view."""
        self._handle = handle
        self._field = field

    def __repr__(self) -> str:
        """Its shape, type and place; the numbers are not read."""
        kind, at = self.__dlpack_device__()
        place = f"device {at}" if kind == CUDA else "the host"
        return f"<drape.SharedArray: {self.shape} {self.dtype} on {place}>"

    def __len__(self) -> int:
        """The number of vertices."""
        return self.shape[0]

    def _view(self) -> Any:
        view = ffi.new("drape_view *")
        with self._handle.lock:
            check(lib.drape_borrow(self._handle.world, view), "borrow")
        return view

    @property
    def shape(self) -> tuple[int, int]:
        """(vertices, 3)."""
        return (int(lib.drape_vertices(self._handle.made)), 3)

    @property
    def dtype(self) -> np.dtype[Any]:
        """float32 or float64, as the world's precision."""
        return np.dtype(f"<f{self._handle.definition.precision // 8}")

    def _interface(self, device: bool) -> tuple[dict[str, Any], Any]:
        view = self._view()
        if (view.device >= 0) != device:
            where = "on a device" if view.device >= 0 else "on the host"
            raise AttributeError(f"the array is {where}")
        about = {
            "shape": self.shape,
            "typestr": self.dtype.str,
            "data": (address(getattr(view, self._field)), True),
            "version": 3,
        }
        return about, view

    @property
    def __array_interface__(self) -> dict[str, Any]:
        """NumPy's; an AttributeError where the array is on a device."""
        return self._interface(False)[0]

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        """Version 3 of it; an AttributeError where the array is on the host."""
        about, view = self._interface(True)
        # 1 is the default stream, which 0 may not name
        return {**about, "stream": address(view.stream) or 1}

    def __dlpack_device__(self) -> tuple[int, int]:
        """(1, 0): the host; (2, n): CUDA's device n."""
        device = self._view().device
        return (CUDA, device) if device >= 0 else (CPU, 0)

    def __dlpack__(
        self,
        *,
        stream: int | None = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any:
        """Returns a capsule with the array as it is now.

        Args:
            stream: of the caller, which waits for the world's: None or 1: the
                default one, 2: the thread's default one, -1: none waits
            max_version: 1.x is told that the array is read-only; on the host
                others are refused
            dl_device, copy: only what needs no copy
        """
        view = self._view()
        here = (CUDA, view.device) if view.device >= 0 else (CPU, 0)
        if copy or dl_device not in (None, here):
            raise BufferError("the array is shared where it lies, without a copy")
        if here[0] == CPU and stream is not None:
            raise BufferError("an array on the host has no stream")
        if here[0] == CUDA and stream != -1:
            order(view.stream, stream)
        versioned = max_version is not None and max_version[0] >= 1
        if not versioned:
            _tell_read_only(here[0])
        data, n = getattr(view, self._field), view.vertices
        # the tensor owns a reference to this, and this keeps the world
        tensor = lib.core_tensor(
            ffi.cast("void *", data),
            n,
            FLOAT,
            view.precision,
            *here,
            versioned,
            ffi.cast("void *", id(self)),
        )
        if not tensor:
            raise MemoryError("a tensor of DLPack")
        name = b"dltensor_versioned" if versioned else b"dltensor"
        end = address(ffi.addressof(lib, "core_tensor_end"))
        return _capsule(address(tensor), name, end)


def _tell_read_only(kind: int) -> None:
    """Refuses, or warns of, a consumer that might write to an array."""
    why = (
        "the consumer asks for DLPack before version 1, which does not tell that "
        "the array is read-only: "
    )
    if kind == CPU:
        raise BufferError(f"{why}give it a copy, numpy.array(array)")
    warnings.warn(f"{why}write to a copy of it only", stacklevel=3)


def order(stream: Any, later: int | None) -> None:
    """Makes the stream `later` wait for what is on `stream` now."""
    if later == 0:
        raise BufferError("stream 0 is ambiguous: 1 is the default stream")
    handle = ffi.cast("void *", later if later is not None else 1)
    status = lib.core_stream_wait(stream, handle)
    if status:
        raise DeviceError(
            "built without CUDA" if status < 0 else f"streams: CUDA's error {status}"
        )
