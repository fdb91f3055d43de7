#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the package on a machine with a GPU that has Python, NumPy, pytest and,
# for the tests that share memory, torch and CuPy, but no network.
# usage: python/device.sh pack WHEEL FOLDER [VERSION]
#            puts into FOLDER the wheel, which `make wheel GPU=yes` made, and what
#            it needs beside NumPy, for that machine's Python (3.12)
#        python/device.sh run FOLDER
#            there, in the repository's root: the tests of a device, and the
#            notebooks with their device's cells
set -eu
usage() {
    sed -n 's/^# usage: //p' "$0" >&2
    exit 2
}
case ${1-}:$# in
pack:3 | pack:4)
    wheel=$2 to=$3 version=${4-3.12}
    case $wheel in
    *+cu*) ;;
    *)
        echo "$wheel: built without the device's part: make wheel GPU=yes" >&2
        exit 1
        ;;
    esac
    mkdir -p "$to"
    rm -f "$to"/*.whl
    cp "$wheel" "$to"
    python3 -m pip download -q --no-deps --only-binary=:all: -d "$to" \
        --python-version "$version" --implementation cp \
        --platform manylinux_2_28_x86_64 --platform manylinux_2_17_x86_64 \
        --platform manylinux2014_x86_64 cffi pycparser
    du -sh "$to"
    ;;
run:2)
    site=$(mktemp -d)
    trap 'rm -rf "$site"' EXIT
    python3 -m pip install -q --no-index --no-deps --target "$site" "$2"/*.whl
    export PYTHONPATH="$site"
    # without these all would be skipped
    PYTHONPATH=$site:python/tests python3 -c 'import cells, sys
sys.exit(cells.why_not("device") or cells.why_not("torch") or 0)'
    python3 -m pytest -v -rs -p no:cacheprovider \
        python/tests/test_device.py python/tests/test_notebook.py
    python3 python/tests/cells.py python/docs/tutorials/*.ipynb
    ;;
*) usage ;;
esac
