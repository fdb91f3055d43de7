# SPDX-License-Identifier: Apache-2.0
"""drape: certified high-resolution cloth simulation.

A scene becomes a `World`, which `World.step` advances::

    import drape

    sheet = drape.Cloth(particles=[51, 51], start=drape.Start(at=[0, 1, 0]))
    ball = drape.Obstacle(shape="sphere", radius=0.3, at=[0, 0.5, 0])
    world = drape.World(drape.Scene(cloths=[sheet], obstacles=[ball]))
    reports = world.step(60)
    assert reports.clean and world.audit().count == 0
    print(world.positions[world.bodies[0].vertices].min(axis=0))

Units are SI. Results are the same to the last bit on every machine, with any
number of threads, on the CPU and on a GPU.
"""

from importlib.metadata import version as _version

from . import _whose, examples, export, tool
from ._core import ffi as _ffi
from ._core import lib as _lib
from .arrays import SharedArray
from .bodies import Body
from .contacts import Contacts
from .errors import (
    CheckpointError,
    DeviceError,
    DivergedError,
    Error,
    OutOfMemoryError,
    SceneError,
)
from .export.film import film
from .fabrics import Fabric, materials
from .many import step_many
from .mesh import Audit, Touches, audit, ccd, ccd_mesh
from .meshes import Mesh, read_meshes
from .pins import Pins, Pose
from .record import Recorder
from .referee import Verdict, audit_frames
from .reports import Memory, Outcome, PlanRow, Status, StepReport, Work
from .scene import (
    Attach,
    Bend,
    Camera,
    Cloth,
    Frames,
    Garment,
    Key,
    Look,
    Material,
    Motion,
    Obstacle,
    Panel,
    Pin,
    Region,
    Scene,
    Start,
    Wind,
)
from .sewing import Attachment, Seam, Sewn, SewnFrame, sew
from .sweeps import Sweep, Variant, grid, sample, sweep
from .uvmesh import Chart, UVMesh
from .viewer.show import Viewer, view
from .world import Reports, World

__version__ = _version(_whose.NAME)


def info() -> str:
    """Returns four lines: the version, the precisions of each backend, and what
    the certificate says of this code."""
    return str(_ffi.string(_lib.drape_info()).decode())


__all__ = [
    "Attach",
    "Attachment",
    "Audit",
    "Bend",
    "Body",
    "Camera",
    "Chart",
    "CheckpointError",
    "Cloth",
    "Contacts",
    "DeviceError",
    "DivergedError",
    "Error",
    "Fabric",
    "Frames",
    "Garment",
    "Key",
    "Look",
    "Material",
    "Memory",
    "Mesh",
    "Motion",
    "Obstacle",
    "OutOfMemoryError",
    "Outcome",
    "Panel",
    "Pin",
    "Pins",
    "PlanRow",
    "Pose",
    "Recorder",
    "Region",
    "Reports",
    "Scene",
    "SceneError",
    "Seam",
    "Sewn",
    "SewnFrame",
    "SharedArray",
    "Start",
    "Status",
    "StepReport",
    "Sweep",
    "Touches",
    "UVMesh",
    "Variant",
    "Verdict",
    "Viewer",
    "Wind",
    "Work",
    "World",
    "audit",
    "audit_frames",
    "ccd",
    "ccd_mesh",
    "examples",
    "export",
    "film",
    "grid",
    "info",
    "materials",
    "read_meshes",
    "sample",
    "sew",
    "step_many",
    "sweep",
    "tool",
    "view",
]
