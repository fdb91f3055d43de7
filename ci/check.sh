#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make check`: builds everything, runs all parts of ci/part.sh, one more at a
# time than there are processors, as Python's waits for browsers and clusters, and
# adds up their counts.
# usage: ci/check.sh BUILD
set -u
build=$1
counts=$build/check.counts
mkdir -p "$build"
: >"$counts"
cores=$(nproc)

sh ci/part.sh "$build" build "$cores"
# The longest parts start first.
parts="python tests asan gcc-O0 clang-O0 tsan msan tool clang-O2 clang-O3 gcc-O3
       tidy demo counts buddha fuzz device validate root self maps embed accuracy prove
       golden-1 golden-3 format rows tokens certificate"
# shellcheck disable=SC2086
printf '%s\n' $parts | xargs -P $((cores + 1)) -n 1 sh ci/part.sh "$build"
echo "certificate: $(python3 ci/certificate.py line ci/certificate.json)"

# A part that ended without a line of counts has failed.
# shellcheck disable=SC2086
set -- build $parts
awk -v parts=$# '
    { passed += $1; failed += $2; skipped += $3 }
    END {
        failed += parts - NR
        line = passed + 0 " passed, " failed + 0 " failed"
        print skipped ? line ", " skipped " skipped" : line
        exit failed || !passed
    }' "$counts"
