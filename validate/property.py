# SPDX-License-Identifier: Apache-2.0
"""Properties: values at several sizes, their error and order of convergence, and
whether they meet their bars. spec/validation.md §1"""
import math
from dataclasses import dataclass, field

import numpy as np

SIZES = 4


def slope(size, error):
    """The slope of errors over sizes, on logarithmic scales, by least squares; NaN of
    fewer than two."""
    n, x, y = len(size), np.log(size), np.log(error)
    if n < 2:
        return math.nan
    sx, sy, xx, xy = (np.cumsum(each)[-1] for each in (x, y, x * x, x * y))
    return (n * xy - sx * sy) / (n * xx - sx * sx)


@dataclass
class Property:
    """A property at several sizes, the coarsest first.

    theory: NaN: none is known, the change by size is judged; bar: the error that is
    allowed, by `share` of theory, or in the unit, NaN: nothing is judged; up_to: the bar
    holds for sizes up to this, 0: the finest; promised: a value beyond the bar is a
    failure; sizes: m of a cell, or s of a step; values: NaN: no state was accepted,
    which meets no bar."""
    name: str
    unit: str
    theory: float
    bar: float
    promised: bool = False
    share: bool = False
    up_to: float = 0
    sizes: list = field(default_factory=list)
    values: list = field(default_factory=list)

    def add(self, size, value):
        assert len(self.sizes) < SIZES, self.name
        self.sizes.append(size)
        self.values.append(np.float64(value))

    def error(self, k):
        """Of value k: from theory, or from the next coarser size."""
        known = not np.isnan(self.theory)
        due = np.float64(self.theory if known else self.values[k - 1] if k else math.nan)
        error = abs(self.values[k] - due)
        return error / abs(due) if self.share else error

    def worst(self):
        """The largest error of the sizes for which the bar holds; NaN beyond all."""
        last = len(self.sizes) - 1
        judged = [self.error(k) for k, size in enumerate(self.sizes)
                  if k == last or size <= self.up_to * (1 + 1e-9)]
        return max(judged) if judged and not np.isnan(judged).any() else math.nan

    def order(self):
        """The slope of the errors that are above rounding."""
        least = [1e-9 if self.share else 1e-9 * abs(value) for value in self.values]
        chosen = [k for k in range(len(self.sizes)) if self.error(k) > least[k]]
        return slope([self.sizes[k] for k in chosen], [self.error(k) for k in chosen])


def everywhere(name, unit, theory, bar, promised=True):
    """A property whose bar holds at all sizes."""
    return Property(name, unit, theory, bar, promised, up_to=1)


def measure(v, properties, sizes, found):
    """Ends properties after what `found` returns at each size: a value of each."""
    for size in sizes:
        values = found(size)
        for p, value in zip(properties, values if len(properties) > 1 else [values]):
            p.add(size, value)
    for p in properties:
        v.end(p)
