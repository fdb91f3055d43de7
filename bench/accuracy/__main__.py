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
from bench.accuracy.run import Bench
from bench.accuracy.scenes import Sample
from validate.command import parse

PARTS = {"orders": orders.orders, "work": work.work, "newton": work.newton,
         "stability": stability.stability, "stress": stress.stress,
         "contact": contact.contact, "drift": drift.drift, "skip": skip.skip,
         "backends": work.backends}


def main():
    parser = argparse.ArgumentParser("accuracy", description="Writes PART.csv.")
    parser.add_argument("--inside", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--bare", choices=("package", "inside"), help=argparse.SUPPRESS)
    options = parse(parser, PARTS)
    np.seterr(all="ignore")
    b = Bench(options.directory, options.quick, options.backend, Inside(options.inside))
    _, text = Sample(b, "hanging", 5).create()
    if text:
        sys.exit(f"accuracy: {text}")
    if options.bare:
        skip.bare(b, b.inside if options.bare == "inside" else lib)
        return 0
    for part in options.parts:
        start = time.process_time()
        PARTS[part](b)
        print(f"{part}: {time.process_time() - start:.1f} s", file=sys.stderr)
    print(f"{b.passed} passed, {b.failed} failed")
    return int(b.failed or not b.passed)


if __name__ == "__main__":
    sys.exit(main())
