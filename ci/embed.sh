#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the installed library: installs it into an empty folder, moves that
# folder, and builds the examples against it alone, in C and C++, by pkg-config
# and by CMake, with the archive and with the shared library; also beside
# functions that are named as some of the library's. Compiles the README's
# example, and 5_share.cu if nvcc is installed.
# What each program of the course prints is held against theory, and so is what a
# program with a fault prints, which must not hold.
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
course='1_hang 2_drop 3_pull 4_resume 5_share'
# holds NAME PROGRAM: the program ends well, and the numbers that it prints are as
# theory or an invariant has it, which the comment of app/examples/NAME.c tells.
# Cotton has 0.2 kg/m2, stretch 1000 N/m and shear 300 N/m; E is that of a strip.
holds() {
    "$2" >"$work/said" || return 3
    cat "$work/said"
    grep -oE -e '-?[0-9]+(\.[0-9]+)?(e[-+][0-9]+)?' "$work/said" | tr '\n' ' ' |
        awk -v name="$1" '
        function near(a, b, part) { return a > b * (1 - part) && a < b * (1 + part) }
        function e(stretch) { return stretch - 300 ^ 2 / stretch }
        { g = 9.81; good = 0 }
        name == "1_hang" { good = $1 == 60 &&
            near($3, 1000 * 0.2 * g / 2 / e(1000), 0.01) }
        name == "2_drop" { press = 0.2 * 0.5 ^ 2 * g * 0.8
            good = $1 == 90 && near($3, press, 0.001) &&
            near($4, 0.25 * press, 0.001) &&
            near($5, g * (0.6 - 0.25 * 0.8), 0.001) }
        name == "3_pull" { part = 0.02 ^ 2 * 0.05 / 2
            good = near($1, part * (e(1000) + e(4000)), 0.005) &&
            near($2, part * (e(2000) + e(4000)), 0.005) }
        name == "4_resume" { good = $1 == 31 ^ 2 - 2 && $2 == 0 }
        name == "5_share" { good = $1 > 0.1 && $2 < 1e-6 && $3 > 0 && $4 == 0 }
        END { exit !good }'
}
# plants NAME EDIT: a fault in a program of the course is seen by its numbers.
plants() {
    sed "$2" "app/examples/$1.c" >"$work/fault.c"
    ! cmp -s "app/examples/$1.c" "$work/fault.c" || return 1
    # shellcheck disable=SC2086
    $CC -std=c17 -w "$work/fault.c" $flags -lm -o "$work/fault" || return 1
    holds "$1" "$work/fault"
    [ $? -eq 1 ]
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
    for name in $course; do
        # shellcheck disable=SC2086
        ok "$name, $kind" $CC -std=c17 $strict "app/examples/$name.c" $libs -lm \
            -o "$work/$name-$kind"
    done
    ok "1_hang holds, $kind" holds 1_hang "$work/1_hang-$kind"
    # shellcheck disable=SC2086
    ok "1_hang.cpp, $kind" $CXX -std=c++17 $strict app/examples/1_hang.cpp $libs \
        -o "$work/hang.cpp-$kind"
    ok "1_hang.cpp holds, $kind" holds 1_hang "$work/hang.cpp-$kind"
done
for name in ${course#1_hang }; do
    ok "$name holds" holds "$name" "$work/$name-shared"
done
ok '1_hang, a fault' plants 1_hang 's/drape_default(&def);/& def.gravity[1] = -9.6;/'
ok '2_drop, a fault' plants 2_drop 's/FRICTION = 0.25/FRICTION = 0.26/'
ok '3_pull, a fault' plants 3_pull 's/material.stretch \*= 2/material.stretch *= 2.1/'
ok '4_resume, a fault' plants 4_resume 's/drape_load(.*saved)/DRAPE_OK/'
ok '5_share, a fault' plants 5_share 's/v = view.v/v = view.x/'
# shellcheck disable=SC2016
needed='readelf -d "$0" | grep -q "NEEDED.*\[libdrape.so.[0-9.]*\]"'
ok 'the one needs libdrape.so' sh -c "$needed" "$work/1_hang-shared"
ok 'the other does not' sh -c "! $needed" "$work/1_hang-static"

# With the GPU part, the same bits on the device: the example prints a position.
if command -v nvcc >/dev/null && [ -e /dev/nvidiactl ]; then
    sed 's/def.n_cloths = 1;/& def.backend = DRAPE_GPU;/' \
        app/examples/1_hang.cpp >"$work/gpu.cpp"
    for kind in shared static; do
        libs=$flags
        [ $kind = shared ] || libs=$parts
        # shellcheck disable=SC2086
        ok "1_hang.cpp for the GPU, $kind" $CXX -std=c++17 $strict \
            "$work/gpu.cpp" $libs -o "$work/gpu-$kind"
        # shellcheck disable=SC2016
        ok "hangs there, too, $kind" sh -c \
            '[ "$("$0")" = "$("$1")" ] && [ -n "$("$0")" ]' \
            "$work/gpu-$kind" "$work/hang.cpp-$kind"
    done
else
    skip '1_hang.cpp for the GPU: there is no device, or no nvcc'
fi

# The same by CMake.
if command -v cmake >/dev/null; then
    for kind in ON OFF; do
        out=$work/cmake-$kind
        ok "CMake configures, shared $kind" cmake -S app/examples -B "$out" \
            -DCMAKE_PREFIX_PATH="$usr" -DBUILD_SHARED_LIBS=$kind
        ok "CMake builds, shared $kind" cmake --build "$out"
        ok "1_hang_cpp of it, shared $kind" holds 1_hang "$out/1_hang_cpp"
    done
    for name in $course; do
        ok "$name of it, static" holds "$name" "$work/cmake-OFF/$name"
    done
    ok 'CMake linked the shared library' sh -c "$needed" "$work/cmake-ON/1_hang"
    ok 'CMake linked the archive' sh -c "! $needed" "$work/cmake-OFF/1_hang"
    # asks WHAT: configures a project that asks for drape so.
    asks() {
        mkdir -p "$work/asks"
        printf '%s\n' 'cmake_minimum_required(VERSION 3.16)' 'project(asks C)' \
            "find_package(drape $1 REQUIRED)" >"$work/asks/CMakeLists.txt"
        cmake -S "$work/asks" -B "$work/asks/out" -DCMAKE_PREFIX_PATH="$usr"
    }
    number() { sed -n "s/^#define DRAPE_VERSION_$1 //p" spec/drape.h; }
    major=$(number MAJOR) minor=$(number MINOR) patch=$(number PATCH)
    ok 'CMake: components' asks "$major.$minor.$patch COMPONENTS static shared"
    ok 'CMake: no such component' refused 'no component fast' \
        asks 'COMPONENTS fast'
    for version in 0.$((minor > 0 ? minor - 1 : 0)).9 $major.$minor.$((patch + 7)) \
        $major.$((minor + 1)) $((major + 1)).0; do
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
    cat app/examples/1_hang.c
    echo 'int arena_init(void); int arena_init(void) { return 1; }'
    echo 'double ref_pcg_64; int threads_parallel = 7;'
} >"$work/names.c"
for kind in shared static; do
    libs=$flags
    [ $kind = shared ] || libs=$parts
    # shellcheck disable=SC2086
    ok "1_hang, beside functions of the same names, $kind" $CC -std=c17 $strict \
        "$work/names.c" $libs -o "$work/names-run"
    ok "that holds, too, $kind" holds 1_hang "$work/names-run"
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
# What CONTRIBUTING.md's recipe for a tag changes with it.
version=$(sed -n 's/.*DRAPE_VERSION "\(.*\)"/\1/p' spec/drape.h)
exact=$(echo "$version" | sed 's/[.]/[.]/g')
for file in 'drape:app/drape.1' 'version =:app/blender/blender_manifest.toml' \
    'version::CITATION.cff' 'version::ci/conda/recipe.yaml' '^##:CHANGELOG.md'; do
    ok "the version in ${file##*:}" grep -qE "${file%:*} \"?$exact(\"| |$)" \
        "${file##*:}"
done

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
    ok '5_share.cu compiles' nvcc -std=c++20 -Werror all-warnings \
        -I"$usr/include" -c app/examples/5_share.cu -o "$work/share.o"
else
    skip '5_share.cu: there is no nvcc'
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
