#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Proves that device code performs the operations of ref/: ci/equal/prove.py, with the
# solver in an environment of its own; that filters' bounds hold: bounds.py; and that
# integers of many words lose no carry and have room: carries.py, bits.py; that two
# sets of flags are told apart: versions.py; and that machine code has the operations of
# the PTX: sass.py. What is not installed is skipped by name.
# usage: ci/equal/prove.sh BUILD [OPTION...]; ends with `N passed, N failed, N skipped`
set -eu
cd "$(dirname "$0")/../.."
build=$1
shift
venv=$build/equal/venv

skip() {
    echo "skipped: twins: $1"
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
}

python3 ci/equal/bits.py || exit 1
python3 tests/narrow/hardest.py --check || exit 1
command -v nvcc >/dev/null || skip 'there is no nvcc'
clang --version 2>/dev/null | grep -q 'version 14\.' ||
    skip 'clang is not of version 14 (Debian 12 has it)'
python=python3 coq=--coq
case " $* " in
*' --quick '*) coq= ;;
*)
    if [ ! "$venv/made" -nt ci/equal/requirements.txt ]; then
        if python3 -m venv "$venv" && "$venv/bin/python" -m pip install -q \
            -r ci/equal/requirements.txt; then
            touch "$venv/made"
        fi
    fi
    if [ -e "$venv/made" ]; then
        python=$venv/bin/python
    else
        echo 'skipped: what needs the solver: pip has no bitwuzla'
        set -- --quick
    fi
    ;;
esac
if command -v gappa >/dev/null; then
    python3 ci/equal/bounds.py "$build" $coq || exit 1
else
    echo "skipped: filters' bounds: there is no gappa"
fi
[ -z "$coq" ] || python3 ci/equal/versions.py "$build" || exit 1
[ -z "$coq" ] || python3 ci/equal/sass.py "$build" || exit 1
[ ! -e "$venv/made" ] || "$venv/bin/python" ci/equal/carries.py "$build" || exit 1
exec "$python" ci/equal/prove.py "$build" "$@"
