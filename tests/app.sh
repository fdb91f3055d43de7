#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The tool's answers to good and bad input.
# usage: tests/app.sh DRAPE [brief]; ends with `N passed, N failed, N skipped`.
# `brief`: without runs that go no other way through the tool than those that stay, but
# whose numbers are checked. So a build with sanitizers runs it: numbers are for others.
set -u
brief=${2-}
drape=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export PYTHONPATH="$root/tests/app" # programs read PLY by geometry.load
passed=0 failed=0 skipped=0

ok() {
    passed=$((passed + 1))
    echo "ok $1"
}
bad() {
    failed=$((failed + 1))
    echo "not ok $1"
    sed 's/^/    /' err 2>/dev/null | head -n 5
}
skip() {
    skipped=$((skipped + 1))
    echo "skipped $1"
}
# is NAME COMMAND...: the command succeeds.
is() {
    name=$1
    shift
    if "$@" >is.out 2>&1; then ok "$name"; else bad "$name"; fi
}
# exits NAME CODE ARGUMENTS...: drape exits so; out and err keep its words.
exits() {
    name=$1 code=$2
    shift 2
    "$drape" "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq "$code" ]; then ok "$name"; else bad "$name (exit $got)"; fi
}
# refused NAME TEXT ARGUMENTS...: exit 2, one line on stderr that has the
# text, nothing on stdout, and neither `refused` nor refused.ply comes to be.
refused() {
    name=$1 text=$2
    shift 2
    rm -rf refused refused.ply
    "$drape" "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq 2 ] && [ ! -s out ] && [ "$(wc -l <err)" -eq 1 ] &&
        grep -qF -- "$text" err && [ ! -e refused ] && [ ! -e refused.ply ]; then
        ok "$name"
    else
        bad "$name (exit $got, expected 2 and: $text)"
    fi
}
# scene FILE TEXT: the tiny scene with its last } replaced by the text.
scene() {
    sed '$d' "$root/app/scenes/tiny.json" >"$1"
    printf '%s\n' "$2" >>"$1"
}
# obstacle FILE: the tiny cloth over this mesh.
obstacle() {
    cat >mesh.json <<EOF
{"frames": 1,
 "cloths": [{"particles": [5, 5], "size": [0.4, 0.4],
   "start": {"at": [0, 2, 0]}}],
 "obstacles": [{"mesh": "$1"}]}
EOF
}
cp "$root/app/scenes/tiny.json" tiny.json

. "$root/tests/garment/pattern.sh"
. "$root/tests/garment/sew.sh"
. "$root/tests/garment/attach.sh"
. "$root/tests/garment/start.sh"
. "$root/tests/garment/sequence.sh"
# In this order, as later ones use what earlier ones have written.
for part in help input hostile motions scenes read geometry run resume folder audit \
    files ccd memory manners calls look data; do
    # shellcheck disable=SC1090
    . "$root/tests/app/$part.sh"
done

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
