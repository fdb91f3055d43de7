# SPDX-License-Identifier: Apache-2.0
"""The ways to integrate that are implicit. spec/validation.md §13"""
from dataclasses import dataclass

from drape._core import lib


@dataclass(frozen=True)
class Scheme:
    name: str
    integrator: int
    newton: int


SCHEMES = (Scheme("baraff-witkin", lib.DRAPE_BW, 0),
           Scheme("baraff-witkin with newton 4", lib.DRAPE_BW, 4),
           Scheme("bdf2", lib.DRAPE_BDF2, 0), Scheme("choi-ko", lib.DRAPE_CK, 0))
PLAIN = SCHEMES[0]


def schemes(v):
    """Those that are run: binary32 has the first alone."""
    return SCHEMES if v.bits == 64 else SCHEMES[:1]
