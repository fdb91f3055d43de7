# SPDX-License-Identifier: Apache-2.0
# Written by python/generate.py from spec/drape.h.
"""What the library reports: the enumerations and structs of drape.h."""

from __future__ import annotations

import enum
from dataclasses import dataclass

# The keys of StepReport.seconds, in the order of enum drape_part.
PARTS = (
    "integration",
    "solver",
    "broad",
    "proximity",
    "penetration",
)


class Status(enum.IntEnum):
    """What a call of the library returns.

    Attributes:
        OK
        EARG: an argument is NULL or out of its range
        EDATA: a number is not finite or beyond 2^60
        ENOMEM: an allocator returned NULL
        EFULL: an output is too small. Stages return this status to the
            pipeline; no function of this header does
        ESTART: at the start cloth intersects itself, other cloth or an
            obstacle, or a triangle without area touches another triangle
            (narrow/audit.md §5)
        EDEVICE: this build or machine lacks the backend, or the device has
            failed
        EMATCH: the checkpoint or log is damaged, or belongs to another
            definition, precision or format
        EIO: a function of the caller's ended the call
        ELIMIT: the step would need more than the definition allows: substeps
            beyond max_substeps
    """

    OK = 0
    EARG = -1
    EDATA = -2
    ENOMEM = -3
    EFULL = -4
    ESTART = -5
    EDEVICE = -6
    EMATCH = -7
    EIO = -8
    ELIMIT = -9


class Outcome(enum.IntFlag):
    """How a step ended: nothing, or some of these.

    Attributes:
        UNCONVERGED: the linear solver did not reach its tolerance
        ZONES: impulses did not part all pairs, and impact zones were used
            (contact/zones.md)
        ROLLBACK: zones did not suffice either, and vertices were put back
            (contact/rollback.md)
        TRAPPED: the state at the end of the step intersects: obstacles or pins
            that move left no room, or the start intersected. Every step has
            this outcome until no intersecting pair is left
        DIVERGED: energy appeared from nothing, or a value was not finite. The
            state and the time are those before the step (cloth/dynamics.md §3)
        ASLEEP: all cloths are asleep and no body moves: the step was skipped
        PASSED: cloth went through something during the step, which the response
            could not prevent; at the end of the step nothing intersects
    """

    UNCONVERGED = 1
    ZONES = 2
    ROLLBACK = 4
    TRAPPED = 8
    DIVERGED = 16
    ASLEEP = 32
    PASSED = 64


@dataclass(frozen=True)
class Work:
    """The work that a step did; all is 0 in a step asleep.

    Attributes:
        tries: slices begun; the report's `slices` were kept
        solves: linear systems solved, without and with contacts
        queries: queries of the broad phase
        narrow: runs of the narrow phase
        boxes: boxes of the BVH that queries refitted
        boxes_kept: boxes that they left as they were: those of obstacles that
            never move, or all where whole meshes are apart
        walked: pairs of boxes that the walk visited
        cleared: pairs of boxes that meet and were not entered, as tangent cones
            exclude contact (broad/cones.md)
        near: pairs of primitives given to proximity
        later: those of the report's `candidates` that were found in rounds
            after the first
    """

    tries: int
    solves: int
    queries: int
    narrow: int
    boxes: int
    boxes_kept: int
    walked: int
    cleared: int
    near: int
    later: int


@dataclass(frozen=True)
class StepReport:
    """What a step did. Counts marked (*) include slices that were taken again.

    Attributes:
        step: steps done since time 0, with this one unless it diverged
        time: s, at the end of the step
        outcome: bitwise or of enum drape_outcome; 0: clean
        slices: slices that make up the step, 1 … max_slices
        substeps: most substeps of the integrator in a slice
        iterations: (*) of the linear solver, all solves together
        residual: relative, the largest: of solves without contacts, and of what
            those with contacts left undone
        rounds: (*) detections of penetration after the solves with contacts, of
            which the last in a clean slice finds no pair; 0 where nothing was
            near anything
        asleep: cloths asleep at the end of the step
        contacts: pairs near, contact/proximity.md, last slice
        impacts: pairs found to penetrate, all rounds
        candidates: (*) pairs given to the narrow phase, all rounds
        zone_vertices, rolled_back: vertices that the fail-safe moved in zones,
            and that it put back
        intersecting: intersecting pairs of triangles at the end of the step, as
            drape_audit counts them; not 0 only with DRAPE_TRAPPED
        sewn: pairs that intersect beside a seam, which are not in
            `intersecting` (seam/seam.md §5), where this step had to count
            pairs; else 0
        kinetic, elastic, potential: J, of all cloths, at the end of the step;
            potential: of gravity, 0 at the origin
        seconds: (*) wall time of each part
        work: (*) what was computed
    """

    step: int
    time: float
    outcome: Outcome
    slices: int
    substeps: int
    iterations: int
    residual: float
    rounds: int
    asleep: int
    contacts: int
    impacts: int
    candidates: int
    zone_vertices: int
    rolled_back: int
    intersecting: int
    sewn: int
    kinetic: float
    elastic: float
    potential: float
    seconds: dict[str, float]
    work: Work


@dataclass(frozen=True)
class PlanRow:
    """A row of a world's plan: a stage, whether it is used, and why.

    Attributes:
        stage: name, static
        on: 1: the scene uses the stage
        why: a few words, static
        bytes: of memory held now for the row's streams
    """

    stage: str
    on: bool
    why: str
    bytes: int


@dataclass(frozen=True)
class Memory:
    """Memory of a world's streams and records.

    Attributes:
        host_bytes, device_bytes: held now
        borrowed_bytes: part of device_bytes: memory of the solver that contact
            uses between solves
        host_allocations, device_allocations: since drape_create
    """

    host_bytes: int
    device_bytes: int
    borrowed_bytes: int
    host_allocations: int
    device_allocations: int
