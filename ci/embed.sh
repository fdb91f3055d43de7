#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the installed library: installs it into an empty folder, moves that
# folder, and builds the examples against it alone, in C and C++, by pkg-config
# and by CMake, with the archive and with the shared library; also beside
# functions that are named as some of the library's. Compiles the README's
# example, and share if nvcc is installed.
# usage: ci/embed.sh BUILD
set -u
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
log=$work/log
. ci/ok.sh
skip() {
    skipped=$((skipped + 1))
    echo "skipped: $1"
}
# says PROGRAM TEXT: the program ends well and its output begins so.
says() {
    "$1" >"$work/said" && grep -q "^$2" "$work/said"
}
# refused TEXT COMMAND...: the command fails, and says this.
refused() {
    text=$1
    shift
    ! "$@" >"$work/said" 2>&1 && tr '\n' ' ' <"$work/said" | tr -s ' ' |
        grep -q "$text"
}

export CC="${CC:-gcc}" CXX="${CXX:-g++}"
multi=lib/$($CC -print-multiarch) # Debian's LIBDIR, of two parts
ok install make BUILD="$build" DESTDIR="$work/at first" PREFIX=/usr \
    LIBDIR="$multi" install
usr=$work/usr lib=$work/usr/$multi
mv "$work/at first/usr" "$usr"
archive=$lib/libdrape.a
export PKG_CONFIG_PATH="$lib/pkgconfig" LD_LIBRARY_PATH="$lib"
strict="-Wall -Wextra -Wpedantic -Werror"
if command -v pkg-config >/dev/null; then
    flags=$(pkg-config --cflags --libs drape)
    parts=$(pkg-config --cflags drape)\ $archive\ $(
        pkg-config --static --libs-only-l --libs-only-other drape |
            sed 's/-ldrape//')
    # shellcheck disable=SC2016
    ok "pkg-config's version" sh -c 'pkg-config --modversion drape |
        grep -qx "$(sed -n "s/.*DRAPE_VERSION \"\(.*\)\"/\1/p" spec/drape.h)"'
else
    flags="-I$usr/include -L$lib -ldrape"
    parts="-I$usr/include $archive -pthread -lm"
fi

# The examples, with the shared library and with the archive.
for kind in shared static; do
    libs=$flags
    [ $kind = shared ] || libs=$parts
    # shellcheck disable=SC2086
    ok "hang, $kind" $CC -std=c17 $strict app/examples/hang.c $libs \
        -o "$work/hang-$kind"
    ok "hang hangs, $kind" says "$work/hang-$kind" '60 of 60 steps clean'
    # shellcheck disable=SC2086
    ok "hang.cpp, $kind" $CXX -std=c++17 $strict app/examples/hang.cpp $libs \
        -o "$work/hang.cpp-$kind"
    ok "hang.cpp hangs, $kind" says "$work/hang.cpp-$kind" \
        '30 of 30 steps clean'
done
# shellcheck disable=SC2016
needed='readelf -d "$0" | grep -q "NEEDED.*\[libdrape.so.[0-9.]*\]"'
ok 'the one needs libdrape.so' sh -c "$needed" "$work/hang-shared"
ok 'the other does not' sh -c "! $needed" "$work/hang-static"

# With the GPU part, the same bits on the device: the example prints a position.
if command -v nvcc >/dev/null && [ -e /dev/nvidiactl ]; then
    sed 's/def.n_cloths = 1;/& def.backend = DRAPE_GPU;/' \
        app/examples/hang.cpp >"$work/gpu.cpp"
    for kind in shared static; do
        libs=$flags
        [ $kind = shared ] || libs=$parts
        # shellcheck disable=SC2086
        ok "hang.cpp for the GPU, $kind" $CXX -std=c++17 $strict \
            "$work/gpu.cpp" $libs -o "$work/gpu-$kind"
        # shellcheck disable=SC2016
        ok "hangs there, too, $kind" sh -c \
            '[ "$("$0")" = "$("$1")" ] && [ -n "$("$0")" ]' \
            "$work/gpu-$kind" "$work/hang.cpp-$kind"
    done
else
    skip 'hang.cpp for the GPU: there is no device, or no nvcc'
fi

# The same by CMake.
if command -v cmake >/dev/null; then
    for kind in ON OFF; do
        out=$work/cmake-$kind
        ok "CMake configures, shared $kind" cmake -S app/examples -B "$out" \
            -DCMAKE_PREFIX_PATH="$usr" -DBUILD_SHARED_LIBS=$kind
        ok "CMake builds, shared $kind" cmake --build "$out"
        ok "hang of it, shared $kind" says "$out/hang" '60 of 60 steps clean'
        ok "hang_cpp of it, shared $kind" says "$out/hang_cpp" \
            '30 of 30 steps clean'
    done
    ok 'CMake linked the shared library' sh -c "$needed" "$work/cmake-ON/hang"
    ok 'CMake linked the archive' sh -c "! $needed" "$work/cmake-OFF/hang"
    # asks WHAT: configures a project that asks for drape so.
    asks() {
        mkdir -p "$work/asks"
        printf '%s\n' 'cmake_minimum_required(VERSION 3.16)' 'project(asks C)' \
            "find_package(drape $1 REQUIRED)" >"$work/asks/CMakeLists.txt"
        cmake -S "$work/asks" -B "$work/asks/out" -DCMAKE_PREFIX_PATH="$usr"
    }
    ok 'CMake: components' asks '0.1.0 COMPONENTS static shared'
    ok 'CMake: no such component' refused 'no component fast' \
        asks 'COMPONENTS fast'
    for version in 0.0.9 0.1.7 0.2 1.0; do
        ok "CMake: not version $version" refused 'compatible with requested' \
            asks $version
    done
else
    skip 'CMake: there is no cmake (sh ci/deps.sh installs it)'
fi

# Only the names of drape.h are global, so that an embedder may use all others.
for how in "-g $archive" "-D $lib/libdrape.so"; do
    # shellcheck disable=SC2016
    ok "only drape_* is global: ${how##*/}" sh -c 'nm --defined-only $0 >"$1" &&
        grep -q " T drape_step$" "$1" &&
        ! grep " [A-Za-z] " "$1" | grep -v " drape_"' "$how" "$work/names"
done
# shellcheck disable=SC2016
ok 'the soname is that of a link' sh -c 'name=$(readelf -d "$0/libdrape.so" |
    sed -n "s/.*soname: \[\(.*\)\]/\1/p") && test -h "$0/$name" -a -e "$0/$name"' \
    "$lib"
{
    cat app/examples/hang.c
    echo 'int arena_init(void); int arena_init(void) { return 1; }'
    echo 'double ref_pcg_64; int threads_parallel = 7;'
} >"$work/names.c"
for kind in shared static; do
    libs=$flags
    [ $kind = shared ] || libs=$parts
    # shellcheck disable=SC2086
    ok "hang, beside functions of the same names, $kind" $CC -std=c17 $strict \
        "$work/names.c" $libs -o "$work/names-run"
    ok "that hangs, too, $kind" says "$work/names-run" '60 of 60 steps clean'
done
{
    printf '#include <stdio.h>\n#include <drape.h>\nint main(void)\n{\n'
    sed -n '/^```c$/,/^```$/{/^```/d;/^#include/d;p}' README.md
    printf 'return 0;\n}\n'
} >"$work/readme.c"
# shellcheck disable=SC2086
ok "README's lines" $CC -std=c17 $strict "$work/readme.c" $flags \
    -o "$work/readme"
# The version as numbers is the version as text.
cat >"$work/version.c" <<'END'
#include <drape.h>
#include <stdio.h>
#include <string.h>
int main(void)
{
    char text[64];
    snprintf(text, sizeof text, "%d.%d.%d", DRAPE_VERSION_MAJOR,
             DRAPE_VERSION_MINOR, DRAPE_VERSION_PATCH);
    return strcmp(text, DRAPE_VERSION) != 0;
}
END
# shellcheck disable=SC2086
ok 'the version, compiled' $CC -std=c17 $strict "$work/version.c" \
    -I"$usr/include" -o "$work/version"
ok 'the version as numbers' "$work/version"

# The library neither prints nor exits: it must not use such functions of libc.
# shellcheck disable=SC2016
ok 'nm lists what it takes' sh -c 'nm -u "$0" | grep -qw malloc\\\|free' \
    "$archive"
# shellcheck disable=SC2016
ok 'no printf, no exit' sh -c '! nm -u "$0" | grep -wE \
    "_*(v?f?printf|puts|putchar|fputs|fputc|fwrite|perror|stdout|stderr|exit|\
_Exit|abort|__assert_fail|getenv|system|signal|sigaction|GOMP_parallel|\
__kmpc_fork_call|omp_set_num_threads)\
(_chk)?"' "$archive"

# What `make` says where nothing is there to build with.
# shellcheck disable=SC2016
ok 'make says what it did not build' sh -c 'make -n BUILD="$0" NVCC= GPU= \
    HAS_APP= HAS_ORACLE= APP_H=nowhere.h ORACLE_H=never.h say >"$1" &&
    grep -q "NOT BUILT: the GPU part: there is no nvcc" "$1" &&
    tr -d "\n\\\\" <"$1" | tr -s " \t" " " >"$1.line" &&
    grep -q "NOT BUILT: the tool [^ ]*: there are no headers of: nowhere.h" \
        "$1.line" &&
    grep -q "NOT BUILT: the oracles .*no headers of: never.h" "$1.line"' \
    "$build" "$work/make"

if command -v nvcc >/dev/null; then
    ok 'share compiles' nvcc -std=c++20 -Werror all-warnings \
        -I"$usr/include" -c app/examples/share.cu -o "$work/share.o"
else
    skip 'share.cu: there is no nvcc'
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
