# SPDX-License-Identifier: Apache-2.0
"""Tests of export, view and the Blender add-on."""
