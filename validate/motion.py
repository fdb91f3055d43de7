# SPDX-License-Identifier: Apache-2.0
"""Free fall, and the swing of a hanging sheet. spec/validation.md §5"""
import math
from dataclasses import dataclass

from drape._core import lib

from validate.property import SIZES, Property, everywhere, measure
from validate.world import G, NAN, around, sheet, total, world_of

STEPS = 1 / 60, 1 / 120, 1 / 240, 1 / 960


def fall(v, integrator, dt):
    """The mean depth, m, of a sheet after falling for half a second."""
    s = sheet(v, 11, 11, 0.02)
    s.scene.settings.integrator = integrator
    world = world_of(s, dt)
    if not world or not all([world.step() for _ in range(around(0.5 / dt))]):
        return NAN
    world.read()
    return total((s.x[:, 1] - world.x[:, 1]) / s.count)


LENGTH = 0.4
ZERO = 2.404825557695773  # of J0


def bessel(x):
    """The first mode of a hanging chain: J0 by its series."""
    term = whole = 1
    for k in range(1, 30):
        term *= -x * x / 4 / (k * k)
        whole += term
    return whole


def swing_start(s, h):
    """Hangs a sheet in that mode, its tip 0.3 of its length off; arcs are kept."""
    x = s.x.reshape(s.n, s.m, 3)
    z = y = last = 0
    for j in range(s.n):
        way = 0.3 * LENGTH * bessel(ZERO * math.sqrt(max(0, 1 - j * h / LENGTH)))
        z += way - last if j else 0
        y -= math.sqrt(h * h - (way - last) * (way - last)) if j else 0
        last = way
        x[j, :, 1:] = y, z
    for i in range(s.m):
        s.pin(i, 0)


@dataclass
class Swinger:
    """What a pendulum is swung by, and what is promised of it. euler: its formula is
    backward Euler's; kept: it loses at most this much a period, NaN: not judged."""
    name: str
    integrator: int
    newton: int
    euler: bool
    kept: float


SWINGERS = (Swinger("baraff-witkin", lib.DRAPE_BW, 1, True, NAN),
            Swinger("baraff-witkin with newton 8", lib.DRAPE_BW, 8, True, NAN),
            Swinger("choi-ko", lib.DRAPE_CK, 1, False, NAN),
            Swinger("bdf2", lib.DRAPE_BDF2, 0, False, 0.03))


def swing(v, how, h, dt):
    """The part of the amplitude that a period keeps, between the first two peaks after
    the start; peaks by parabolas."""
    n = around(LENGTH / h) + 1
    s = sheet(v, n, n, h)
    s.scene.settings.integrator, s.scene.settings.newton = how.integrator, how.newton
    swing_start(s, h)
    world = world_of(s, dt)
    a, b, c, peaks, k = 0, 0, 0, [], 0
    while world and len(peaks) < 2 and k * dt < 5 and world.step():
        world.read()
        a, b, c = b, c, world.x[s.count - 1 - n // 2, 2]
        if k > 2 and b > 0 and b > a and b >= c:
            peaks.append(b + (c - a) * (c - a) / (8 * (2 * b - a - c)))
        k += 1
    return peaks[1] / peaks[0] if len(peaks) == 2 else NAN


def euler(dt):
    """What exact backward Euler keeps of an oscillation of the chain."""
    w = ZERO / 2 * math.sqrt(G / LENGTH) * dt
    return (1 + w * w)**(-math.pi / math.atan(w))


def motion(v):
    falls = [("euler", lib.DRAPE_EULER), ("verlet", lib.DRAPE_VERLET),
             ("baraff-witkin", lib.DRAPE_BW), ("choi-ko", lib.DRAPE_CK)]
    for name, integrator in falls[2 if v.quick else 0:]:
        measure(v, [Property(f"free fall for 0.5 s; {name}", "m", G / 8, 0.003, True,
                             True)],
                STEPS, lambda dt, by=integrator: fall(v, by, dt))
    if v.quick and v.bits == 32:
        return
    for how in SWINGERS:
        kept = everywhere(f"pendulum; kept a period; {how.name}", "1", 1, how.kept)
        ratio = everywhere(f"pendulum; {how.name} over exact backward Euler", "1", 1,
                           0.02, how.newton > 1)
        for dt in STEPS[:2 if v.quick else SIZES]:
            part = swing(v, how, 0.05 if v.quick else 0.025, dt)
            kept.add(dt, part)
            ratio.add(dt, part / euler(dt))
        v.end(kept)
        if how.euler:
            v.end(ratio)
    if v.quick:
        return
    dt = 1 / 240
    measure(v, [everywhere("pendulum; baraff-witkin over exact backward Euler at 1/240 s "
                           "by cells", "1", 1, 0.02)],
            (0.05, 0.025, 0.0125, 0.00625),
            lambda h: swing(v, SWINGERS[0], h, dt) / euler(dt))
