# SPDX-License-Identifier: Apache-2.0
"""drape: certified high-resolution cloth simulation."""

__version__ = "0.1.0"
