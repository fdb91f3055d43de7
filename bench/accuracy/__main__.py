# SPDX-License-Identifier: Apache-2.0
"""What accuracy costs, where each method breaks, and what unused features cost: `make
bench`, and with --quick a part of `make check`. Each part writes csv files; results that
must hold are counted as checks. spec/accuracy.md"""
import argparse
import sys
import time

import numpy as np
from drape._core import lib

from bench.accuracy import contact, drift, orders, skip, stability, stress, work
from bench.accuracy.inside import Inside
from bench.accuracy.run import BACKENDS, Bench
from bench.accuracy.scenes import Sample

PARTS = {"orders": orders.orders, "work": work.work, "newton": work.newton,
         "stability": stability.stability, "stress": stress.stress,
         "contact": contact.contact, "drift": drift.drift, "skip": skip.skip,
         "backends": work.backends}


def main():
    parser = argparse.ArgumentParser("accuracy", description="Writes PART.csv.")
    parser.add_argument("--quick", action="store_true", help="a small form")
    parser.add_argument("--backend", choices=BACKENDS, default="ref")
    parser.add_argument("--inside", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--bare", choices=("package", "inside"), help=argparse.SUPPRESS)
    parser.add_argument("directory", metavar="DIRECTORY")
    parser.add_argument("parts", metavar="PART", nargs="*", default=[],
                        help=f"default: all of {' '.join(PARTS)}")
    options = parser.parse_args()
    for part in options.parts:
        if part not in PARTS:
            parser.error(f"there is no part {part}")
    np.seterr(all="ignore")
    b = Bench(options.directory, options.quick, options.backend, Inside(options.inside))
    _, text = Sample(b, "hanging", 5).create()
    if text:
        sys.exit(f"accuracy: {text}")
    if options.bare:
        skip.bare(b, b.inside if options.bare == "inside" else lib)
        return 0
    for name, part in PARTS.items():
        if name in options.parts or not options.parts:
            start = time.process_time()
            part(b)
            print(f"{name}: {time.process_time() - start:.1f} s", file=sys.stderr)
    print(f"{b.passed} passed, {b.failed} failed")
    return int(b.failed or not b.passed)


if __name__ == "__main__":
    sys.exit(main())
