#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the Python package's wheel and puts it into DIST, with all libraries
# that it needs beside glibc inside (auditwheel), so that it installs on every
# Linux of the same or a later glibc. $DRAPE_MAKE, $DRAPE_LOCAL: as for setup.py.
# usage: python/wheel.sh BUILD [DIST]
set -eu
build=$1
dist=${2-dist}
work=$build/python
bin=$work/venv/bin
rm -rf "$work/raw" "$work/repaired" python/build
DRAPE_BUILD=$build "$bin/python" -m build -q --wheel --no-isolation \
    --outdir "$work/raw" python >"$work/wheel.log" 2>&1 || {
    tail -n 40 "$work/wheel.log" >&2
    exit 1
}
# CUDA's driver is the machine's own.
PATH="$(cd "$bin" && pwd):$PATH" "$bin/auditwheel" repair --exclude 'libcuda.so*' \
    --wheel-dir "$work/repaired" "$work"/raw/*.whl >"$work/repair.log" 2>&1 || {
    tail -n 40 "$work/repair.log" >&2
    exit 1
}
# What is linked statically is in no list of libraries: CUDA's runtime.
set -- "$work"/repaired/*.whl
cuda=$(command -v nvcc || true)
case $1 in
*+cu*)
    licence=$(dirname "$(realpath "$cuda")")/../EULA.txt
    if [ -f "$licence" ]; then
        set -- "$1" "cuda=$licence"
    else
        echo "note: no licence of CUDA's runtime: there is no $licence" >&2
    fi
    ;;
esac
"$bin/python" python/licences.py "$@"
mkdir -p "$dist"
rm -f "$dist"/drape_cloth-*.whl
mv "$work"/repaired/*.whl "$dist"/
ls -s --block-size=1M "$dist"/*.whl
