# SPDX-License-Identifier: Apache-2.0
"""Maps of stability: dt against stiffness for each integrator. Each cell says how the
library's run ended, and how a run without the library's limit of the step ended.
spec/accuracy.md §3"""
import math
import re

from drape._core import lib

from bench.accuracy.run import EXPLICIT, IMPLICIT, INTEGRATORS, Run
from bench.accuracy.scenes import Sample


def limit_of(b, sample):
    """The longest step that the library takes without substeps, s, from the error of a
    long step, which says how many substeps it needs. 0: the integrator is never stable;
    infinite: it is implicit."""
    sample.settings.dt = 100
    found = re.search(r"stable from (\d+)", Run(b, sample, 0).text)
    if not found:
        return math.inf
    return 0 if found[1] == "2147483647" else 100 / int(found[1])


def cell(b, out, sample, limit):
    s, a = sample.settings, sample.cloth.material
    run = Run(b, sample, 40 if b.quick else 200)
    explicit = s.integrator in EXPLICIT
    good = (run.word == ("stable" if s.dt < limit else "refused") if explicit else
            run.word != "refused")
    name, forced = INTEGRATORS[s.integrator], ""
    b.check(good, f"{name}, stretch {a.stretch:g}, damping {a.damping:g}, dt {s.dt:g}, "
            f"limit {limit:g}: {run.word}")
    if explicit and b.backend == lib.DRAPE_REF:
        forced = b.inside.forced(sample, 40 if b.quick else 800)
        b.check(forced in ("stable", "diverged"), f"forced {name}, dt {s.dt:g}: {forced}")
    out.row("%g,%s,%d,%g,%g,%.4g,%s,%d,%.3g,%s", a.damping, name, s.precision, a.stretch,
            s.dt, limit, run.word, run.steps, run.residual, forced)


def stability(b):
    each = 3 if b.quick else 1
    with b.table("stability", "damping s,integrator,precision,stretch N/m,dt,limit s,end,"
                 "steps,residual,without the limit") as out:
        for method in (*EXPLICIT, *IMPLICIT):
            for damping in (0, 1e-4):
                for k in range(0, 8, each):
                    sample = Sample(b, "stretched", 7)
                    s, a = sample.settings, sample.cloth.material
                    s.integrator, s.max_substeps = method, 1
                    a.stretch, a.shear, a.damping = 10.0**k, 0.3 * 10.0**k, damping
                    limit = limit_of(b, sample)
                    for h in range(-10, -1, each):
                        s.dt = (3.16228 if h % 2 else 1) * 10.0**(h // 2)
                        cell(b, out, sample, limit)
