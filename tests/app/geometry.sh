# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# What a scene says of shapes, places, starts, holes and pins is so in its frames.
# Read by tests/app.sh, whose functions it calls.

is 'a scene of shapes and starts' python3 "$root/tests/app/geometry.py" write \
    geometry.json
exits 'runs' 0 run geometry.json --out geometry --quiet
is 'they have the places that formulas say' \
    python3 "$root/tests/app/geometry.py" check geometry
exits 'convert --up --size' 0 convert corner.off corner.ply --up 1,2,-1 --size 3
is 'levels, scales and stands a mesh' \
    python3 "$root/tests/app/geometry.py" converted corner.ply
