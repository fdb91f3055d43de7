# SPDX-License-Identifier: Apache-2.0
"""What cloth does against what physics says: `make validate`, and with --quick a part
of `make check`. Each property is measured at several sizes (of cells, or of steps where
time is the question) by the package `drape`. spec/validation.md"""
import argparse
import sys
import time

import numpy as np
from drape._core import lib

from validate import (belt, converge, drapes, grip, impact, layers, meeting, motion,
                      plane, slopes, statue, stickslip, strips)
from validate.command import parse

PARTS = {
    "cylinder": plane.cylinder, "plane": plane.plane, "tension": plane.tension,
    "measured": plane.measured, "cantilever": strips.cantilever,
    "motion": motion.motion, "cusick": drapes.cusick, "fabrics": drapes.fabrics,
    "hung": plane.hung, "contact": slopes.contact, "ball": slopes.ball,
    "statue": statue.statue, "meeting": meeting.meeting, "layers": layers.layers,
    "grip": grip.grip, "impact": impact.impact, "belt": belt.belt,
    "converge": converge.converge, "buckling": strips.buckling,
    "bendtwist": strips.bendtwist, "stickslip": stickslip.stickslip}
VALUES = "part,property,backend,bits,size,value,theory,unit"
PROPERTIES = ("part,property,backend,bits,unit,theory,size 1,size 2,size 3,size 4,"
              "value 1,value 2,value 3,value 4,error,order,bar,promised,result")


def text(number):
    """A number of a table; nothing for one that there is not."""
    return "" if np.isnan(number) else f"{number:.6g}"


class Validate:
    """One run. quick: a small form, for `make check`; fine: 1 mm in §6; bits: of a
    number in the state; known: properties that are not promised, and not met."""

    def __init__(self, options):
        self.folder, self.quick, self.fine = (options.directory, options.quick,
                                              options.fine)
        self.name = options.backend
        self.backend = lib.DRAPE_GPU if self.name == "gpu" else lib.DRAPE_REF
        self.passed = self.failed = self.known = self.bits = 0

    def table(self, kind, part, header):
        path = f"{self.folder}/{kind}-{part}.csv"
        try:
            out = open(path, "w", encoding="utf-8")
        except OSError:
            sys.exit(f"validate: {path}: cannot be written")
        print(header, file=out)
        return out

    def run(self, part, precisions):
        start = time.process_time()
        self.part = part
        with self.table("values", part, VALUES) as self.values, \
                self.table("properties", part, PROPERTIES) as self.properties:
            for self.bits in precisions:
                PARTS[part](self)
        print(f"{part}: {time.process_time() - start:.1f} s", file=sys.stderr)

    def end(self, p):
        """Judges a property, writes its rows and counts it."""
        about = f"{self.part},{p.name},{self.name},{self.bits}"
        for size, value in zip(p.sizes, p.values):
            print(about, text(size), text(value), text(p.theory), p.unit, sep=",",
                  file=self.values)
        error = p.worst()
        judged, good = not np.isnan(p.bar), bool(error <= p.bar)
        result = "shown" if not judged else "met" if good else "MISSED"
        blank = [""] * (4 - len(p.sizes))
        print(about, p.unit, text(p.theory), *map(text, p.sizes), *blank,
              *map(text, p.values), *blank, text(error), text(p.order()), text(p.bar),
              "yes" if p.promised else "no", result, sep=",", file=self.properties)
        self.values.flush()
        self.properties.flush()
        if result == "MISSED":
            print(f"{'FAILED' if p.promised else 'known'} {self.part}, {p.name}, "
                  f"{self.bits} bits: error {error:.3g}, bar {p.bar:.3g}", flush=True)
        self.passed += judged and p.promised and good
        self.failed += judged and p.promised and not good
        self.known += judged and not p.promised and not good


def main():
    parser = argparse.ArgumentParser(
        "validate", description="Writes values-PART.csv and properties-PART.csv.",
        epilog="Exit status 1: a promised property misses its bar.")
    parser.add_argument("--fine", action="store_true", help="cells of 1 mm in §6")
    parser.add_argument("--precision", type=int, choices=(32, 64))
    options = parse(parser, PARTS)
    np.seterr(all="ignore")
    v = Validate(options)
    for part in options.parts:
        v.run(part, [options.precision] if options.precision else [64, 32])
    if v.known:
        print(f"known: {v.known} properties that are not promised miss their bars")
    print(f"{v.passed} passed, {v.failed} failed")
    return int(v.failed or not v.passed)


if __name__ == "__main__":
    sys.exit(main())
