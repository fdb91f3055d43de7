#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the installed library: installs it into an empty folder, builds the
# examples against that folder alone, runs hang, alone and beside functions that
# are named as some of the library's, and compiles the README's example, and
# share if nvcc is installed.
# usage: ci/embed.sh BUILD
set -u
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. ci/ok.sh

ok install make BUILD="$build" DESTDIR="$work" PREFIX=/usr install
export PKG_CONFIG_PATH="$work/usr/lib/pkgconfig"
if command -v pkg-config >/dev/null; then
    flags=$(pkg-config --cflags --libs drape)
else
    flags="-I$work/usr/include -L$work/usr/lib -ldrape -pthread -lm"
fi
strict="-Wall -Wextra -Wpedantic -Werror"
# shellcheck disable=SC2086
ok 'hang, against the installed library' ${CC:-gcc} -std=c17 $strict \
    app/examples/hang.c $flags -o "$work/hang"
# shellcheck disable=SC2016
ok 'hang hangs' sh -c '"$0" | grep -q "^60 of 60 steps clean"' "$work/hang"

# Only the names of drape.h are global, so that an embedder may use all others.
# shellcheck disable=SC2016
ok 'only drape_* is global' sh -c 'nm -g --defined-only "$0" >"$1" &&
    grep -q " T drape_step$" "$1" && ! grep " [A-Za-z] " "$1" | grep -v " drape_"' \
    "$work/usr/lib/libdrape.a" "$work/names"
{
    cat app/examples/hang.c
    echo 'int arena_init(void); int arena_init(void) { return 1; }'
    echo 'double ref_pcg_64; int threads_parallel = 7;'
} >"$work/names.c"
# shellcheck disable=SC2086
ok 'hang, beside functions of the same names' ${CC:-gcc} -std=c17 $strict \
    "$work/names.c" $flags -o "$work/names-run"
# shellcheck disable=SC2016
ok 'that hangs, too' sh -c '"$0" | grep -q "^60 of 60 steps clean"' \
    "$work/names-run"
{
    printf '#include <stdio.h>\n#include <drape.h>\nint main(void)\n{\n'
    sed -n '/^```c$/,/^```$/{/^```/d;/^#include/d;p}' README.md
    printf 'return 0;\n}\n'
} >"$work/readme.c"
# shellcheck disable=SC2086
ok "README's lines" ${CC:-gcc} -std=c17 $strict "$work/readme.c" $flags \
    -o "$work/readme"
echo '#include <drape.h>' >"$work/header.cpp"
# shellcheck disable=SC2086
ok 'the header in C++' ${CXX:-g++} -std=c++17 $strict -fsyntax-only \
    -I"$work/usr/include" "$work/header.cpp"

# The library neither prints nor exits: it must not use such functions of libc.
# shellcheck disable=SC2016
ok 'nm lists what it takes' sh -c 'nm -u "$0" | grep -qw malloc\\\|free' \
    "$work/usr/lib/libdrape.a"
# shellcheck disable=SC2016
ok 'no printf, no exit' sh -c '! nm -u "$0" | grep -wE \
    "_*(v?f?printf|puts|putchar|fputs|fputc|fwrite|perror|stdout|stderr|exit|\
_Exit|abort|__assert_fail|getenv|system|signal|sigaction|GOMP_parallel|\
__kmpc_fork_call|omp_set_num_threads)\
(_chk)?"' "$work/usr/lib/libdrape.a"

if command -v nvcc >/dev/null; then
    ok 'share compiles' nvcc -std=c++20 -Werror all-warnings \
        -I"$work/usr/include" -c app/examples/share.cu -o "$work/share.o"
else
    skipped=1
    echo 'skipped: share.cu: there is no nvcc'
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
