# SPDX-License-Identifier: Apache-2.0
"""Shows a run, recorded or live, on a page for a web browser."""
