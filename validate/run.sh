#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make validate`: every part of build/validate, two at a time, to
# validate/MACHINE; then the plots, where there is matplotlib, and the tables
# of spec/validation.md. Its exit status is 1 if a promised property misses its
# bar. BACKEND=gpu: on a device; PARTS='cusick plane': these alone.
# usage: validate/run.sh BUILD MACHINE
set -u
build=$1 out=validate/$2 status=0
mkdir -p "$out"
# The longest first.
parts=${PARTS-fabrics layers grip impact belt cusick meeting converge cantilever motion contact ball statue hung stickslip buckling bendtwist tension measured plane cylinder}
# shellcheck disable=SC2086
printf '%s\n' $parts | xargs -P 2 -I {} \
    "$build/validate" --backend "${BACKEND-ref}" "$out" {} || status=1
for python in ${PYTHON-} python3 /usr/bin/python3 ''; do
    [ -z "$python" ] || "$python" -c 'import matplotlib' 2>/dev/null && break
done
if [ -n "$python" ]; then
    "$python" -m validate.plots "$out"
else
    echo 'skipped: no plots without python3-matplotlib'
fi
python3 validate/page.py "$out" spec/validation.md
exit $status
