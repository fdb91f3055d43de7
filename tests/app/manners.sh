# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# The tool's manners: how options may be written, standard input and output,
# --quiet, suggestions, what convert writes, and where models are looked for.
# Read by tests/app.sh, whose functions it calls.

# One line says the version.
exits '--version' 0 --version
is 'in one line' sh -c '[ "$(wc -l <out)" -eq 1 ] && grep -qx \
    "drape $(sed -n "s/.*DRAPE_VERSION \"\(.*\)\"/\1/p" "$0")" out' \
    "$root/spec/drape.h"

# Options
exits '--option=value' 0 run tiny.json --frames=2 --out=equals --no-obj
is 'with this value' sh -c '[ "$(ls equals/frames | wc -l)" -eq 3 ]'
refused 'options after -- are names' '--frames: No such file' run -- --frames
refused 'all of them' 'expected one SCENE' run -- tiny.json --frames
exits 'the beginning of one option' 0 run tiny.json --fram 1 --out begun
refused 'the beginning of two' '--f: is the beginning of 2 options' \
    run tiny.json --f 1 --out refused
refused 'a value for a flag' '--force=1: takes no value' \
    run tiny.json --force=1 --out refused
refused 'a value for --quiet' '--quiet=1: takes no value' \
    run tiny.json --quiet=1 --out refused
refused '--quiet, nearly' '--qiet: unknown option; did you mean --quiet?' \
    run tiny.json --qiet
for nearly in --qiet/--quiet --hepl/--help; do
    refused "${nearly%/*} before a command" \
        "${nearly%/*}: unknown option; did you mean ${nearly#*/}?" "${nearly%/*}"
done
refused 'an option that is like none' '--zzzz: unknown option (try: drape help)' \
    run tiny.json --zzzz
refused 'the beginning of --quiet and of none' 'expected one SCENE' run --qui
refused 'no value' '--frames: expected a value' run tiny.json --frames
refused 'an empty value' '--out: expected a value, not an empty' \
    run tiny.json --out=
refused 'a short option' '-x: unknown option' run tiny.json -x
refused 'another' '-q: unknown option' run tiny.json -q
is 'the order of GNU, whatever POSIXLY_CORRECT says' env POSIXLY_CORRECT=1 \
    "$drape" run tiny.json --frames 1 --out posix
refused 'an option that is nearly one' '--frmes: unknown option; did you mean --frames?' \
    run tiny.json --frmes=3 --out refused
refused 'a command that is nearly one' 'rnu: no such command; did you mean run?' rnu
refused 'help for it' 'rendr: no such command; did you mean render?' help rendr
refused 'help for two' 'help: expected one COMMAND' help run audit
refused 'an option in its place' '--vresion: unknown option; did you mean --version?' --vresion
refused 'info with an option' '-x: unknown option' info -x
refused 'a precision' '--precision 16: expected 32 or 64' \
    run tiny.json --precision 16 --out refused
sed 's/^ *"frames"/"precision": 48, &/' tiny.json >bits.json
refused 'one in a scene' 'bits.json: $: precision: expected 32 or 64' \
    run bits.json --out refused
scene key.json ', "gravty": [0, 0, 0]}'
refused 'a key that is nearly one' 'did you mean "gravity"' run key.json

# Nobody reads on: the reader ends before the tool writes.
fails 'a closed pipe' 'standard output: cannot write: Broken pipe' sh -c '
    { sleep 0.2; "$0" help; echo $? >closed; } | :; sleep 0.3; exit "$(cat closed)"' \
    "$drape"

is 'of near names the nearest' python3 "$root/tests/app/nearest.py" "$drape"

# Quiet
exits '--quiet' 0 run tiny.json --out still --frames 2 --quiet
is 'says nothing' test ! -s out -a ! -s err
exits 'render --quiet' 0 render still --width 16 --height 16 --samples 1 --quiet
is 'says nothing either' test ! -s out -a ! -s err
exits 'convert --quiet' 0 convert still/obstacles.ply quiet.ply --quiet
is 'nor this' test ! -s out -a ! -s err -a -s quiet.ply
refused 'but errors are said' 'holds a run' run tiny.json --out still --quiet
exits '--quiet before the command' 0 --quiet run tiny.json --out before --frames 1
is 'says nothing' test ! -s out -a ! -s err -a -s before/report.json
for command in info materials help; do
    exits "$command --quiet" 0 $command --quiet
    is "$command says what it was asked" test -s out -a ! -s err
done
exits '--quiet alone' 2 --quiet

# Progress of a film
exits 'a film, with its progress' 0 render still --width 16 --height 16 \
    --samples 1 --no-film
is 'the last line' grep -q '^\[####################\] picture 3/3  ETA 0:00$' err

# A clock that goes on by $JUMP milliseconds whenever the tool itself looks at it.
cat >jump.c <<'EOF'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
int clock_gettime(clockid_t which, struct timespec *now)
{
    static int looks;
    Dl_info caller;
    void *from = __builtin_return_address(0);
    int (*real)(clockid_t, struct timespec *) =
        (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
    if (!dladdr(from, &caller) || strstr(caller.dli_fname, ".so"))
        return real(which, now);
    long passed = atol(getenv("JUMP")) * looks++;
    now->tv_sec = 1000 + passed / 1000;
    now->tv_nsec = passed % 1000 * 1000000;
    return 0;
}
EOF
# film JUMP LINE...: what a film of three pictures says of its progress
film() {
    env JUMP="${1}000" LD_PRELOAD="$PWD/jump.so" "$drape" render still --width 16 \
        --height 16 --samples 1 --no-film >out 2>err
    jump=$1
    shift
    printf '%s\n' "$@" >expected.txt
    is "a film whose pictures take $jump s each" cmp err expected.txt
}
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC jump.c -o jump.so -ldl 2>/dev/null; then
    skip 'what progress says: no library can stand before this tool'
else
    one='[#######.............] picture 1/3  ETA'
    two='[##############......] picture 2/3  ETA'
    end='[####################] picture 3/3  ETA 0:00'
    film 3 "$one 0:06" "$end" # a line every 5 s
    film 5 "$one 0:10" "$two 0:05" "$end"
    film 95 "$one 3:10" "$two 1:35" "$end"
    film 1799 "$one 59:58" "$two 29:59" "$end"
    film 1800 "$one 1:00:00" "$two 30:00" "$end"
    film 5000 "$one 2:46:40" "$two 1:23:20" "$end"
    film 179999 "$one 99:59:58" "$two 49:59:59" "$end"
    film 900000 "$one 99:59:59" "$two 99:59:59" "$end"
    for jump in 90 110; do
        env JUMP=$jump LD_PRELOAD="$PWD/jump.so" python3 "$root/tests/app/terminal.py" \
            'picture 3/3' "$drape" render still --width 16 --height 16 --samples 1 \
            --no-film >states.$jump
        is "a terminal, pictures of $jump ms" test $? -eq 0
    done
    is 'a terminal is told ten times a second' test "$(cat states.90 states.110)" = '2
3'
fi
is 'a film, on a terminal' python3 "$root/tests/app/terminal.py" 'picture 3/3' \
    "$drape" render still --width 16 --height 16 --samples 1 --no-film
is 'a run, on a terminal' python3 "$root/tests/app/terminal.py" 'step 6/6  contacts' \
    "$drape" run tiny.json --out terminal

# A film, by an ffmpeg that writes down what it is told.
mkdir told
printf '%s\n' '#!/bin/sh' 'printf "%s\n" "$@" >told/words' 'for last; do :; done' \
    'echo film >"$last"' >told/ffmpeg
chmod +x told/ffmpeg
exits 'a run of 2 frames in 0.1 s' 0 run tiny.json --frames 2 --out film --quiet
is 'its film' sh -c 'PATH="$PWD/told:$PATH" "$0" render film --width 16 --height 16 \
    --samples 1 >told/out' "$drape"
is 'is where the tool says' grep -qx film/film.mp4 told/out
is 'is of its pictures, as fast as its frames' sh -c '[ "$(cat film/film.mp4)" = film ] &&
    [ "$(grep -A1 -xe -framerate told/words | tail -n 1)" = 60 ] &&
    [ "$(grep -A1 -xe -i told/words | tail -n 1)" = film/pictures/film_%04d.png ]'

# rate NAME RATE ARGUMENTS...: a film of small pictures has so many a second
rate() {
    name=$1 rate=$2
    shift 2
    env PATH="$PWD/told:$PATH" "$drape" render "$@" --width 16 --height 16 \
        --samples 1 >told/out 2>err
    is "a film's rate: $name" test \
        "$(grep -A1 -xe -framerate told/words | tail -n 1)" = "$rate"
}
exits 'a run of every second frame' 0 run tiny.json --frames 4 --every 2 \
    --out film2 --quiet
sed 's/"frames": 6/"frames": 2, "steps_per_frame": 7, "dt": 0.003/' tiny.json >dt.json
exits 'a run of 21 ms a frame' 0 run dt.json --out film3 --quiet
rate 'of every second frame' 30 film --every 2
rate 'of frames that are two apart' 30 film2
rate 'of every second of those' 15 film2 --every 2
rate 'of frames of 21 ms' 48 film3
rate 'that is told' 7 film2 --rate 7
rate 'once around in six seconds' 2 film --turn 12
rate 'of at least one picture a second' 1 film --turn 3
rate 'around, that is told' 5 film --turn 2 --rate 5

# A film that ffmpeg begins and breaks off leaves nothing behind.
mkdir broken
for end in 'exit 1' 'exit 126' 'kill -9 $$'; do
    printf '%s\n' '#!/bin/sh' 'for last; do :; done' 'echo half >"$last"' "$end" \
        >broken/ffmpeg
    chmod +x broken/ffmpeg
    is "no part of a film is left by $end" sh -c '
        PATH="$PWD/broken:$PATH" "$0" render still --width 16 --height 16 \
            --samples 1 --quiet 2>err
        [ $? -eq 3 ] && grep -q "ffmpeg failed on still/film.mp4" err &&
        [ ! -e still/film.mp4 ] && [ ! -e still/.film.part.mp4 ]' "$drape"
done
printf '%s\n' '#!/bin/sh' 'exit 127' >broken/ffmpeg
is 'an ffmpeg that is not found is none' sh -c '
    PATH="$PWD/broken:$PATH" "$0" render still --width 16 --height 16 \
        --samples 1 2>err && grep -q "no ffmpeg here" err' "$drape"

# Standard input and output
is 'a scene from standard input' sh -c \
    '"$0" run - --out in --frames 2 <tiny.json && cmp in/cloth.pc2 \
    equals/cloth.pc2' "$drape"
is 'a plan of one from a pipe' sh -c \
    'cat tiny.json | "$0" plan - | grep -q "^tiny: "' "$drape"
refused 'an empty one' '-: ' run - --out refused
is 'queries from a pipe' sh -c \
    'cat hit.csv | "$0" ccd --kind vf - | grep -q "^1 0"' "$drape"
is 'a mesh to standard output' sh -c \
    '"$0" convert still/obstacles.ply - >std.ply && cmp std.ply quiet.ply' \
    "$drape"
refused 'a mesh from standard input' '-: no such mesh file' \
    convert - refused.ply

# convert writes what the name says, and what it writes reads back.
for end in obj stl glb dae fbx STL; do
    exits "convert to .$end" 0 convert still/obstacles.ply "to.$end"
    exits "and back from .$end" 0 convert "to.$end" "from.$end.ply"
    is "the same mesh by .$end" python3 "$root/tests/app/mesh.py" same quiet.ply \
        "from.$end.ply"
done
is 'STL is binary STL' sh -c '[ "$(wc -c <to.stl)" -eq \
    $((84 + 50 * $(sed -n "s/^element face //p" quiet.ply))) ]'
is 'glb is glTF' sh -c 'head -c 4 to.glb | grep -q glTF'
is 'dae is COLLADA' grep -q '<COLLADA' to.dae
for end in off gltf usd png ''; do
    rm -f "no.$end"
    refused "convert to .$end" "no.$end: cannot be written; expected" \
        convert still/obstacles.ply "no.$end"
    is "no .$end is left" test ! -e "no.$end"
done

# $DRAPE_MODELS is a list.
mkdir -p 'models a/sub' 'models b'
cp quiet.ply 'models b/one.ply'
cp quiet.ply 'models a/sub/two.ply'
list=$work/nowhere:$work/models\ a:$work/models\ b
for mesh in one.ply sub/two.ply; do
    obstacle $mesh
    is "$mesh in the list" env DRAPE_MODELS="$list" "$drape" plan mesh.json \
        --allow-intersecting
    is "$mesh not in another" sh -c '! DRAPE_MODELS=/usr:$0/nowhere "$1" \
        plan mesh.json' "$work" "$drape"
done
obstacle quiet.ply
mkdir -p elsewhere
cp mesh.json elsewhere
is 'an empty entry is the current folder' env DRAPE_MODELS=/usr: "$drape" \
    plan elsewhere/mesh.json --allow-intersecting

# A start that intersects: which bodies, and the first pair of triangles.
refused 'a start that intersects' 'start.json: the start state is intersecting: cloth 0 (' \
    run start.json --out refused
is 'names both bodies and their triangles' grep -Eq \
    'cloth 0 \(cloth\) triangle [0-9]+ and obstacle [0-9] \([a-z]+\) triangle [0-9]+ \(first of [0-9]+ pairs\)' err

# Threads: all cores unless told, and as many bits.
is 'all cores by default' python3 -c '
import json
assert json.load(open("still/report.json"))["threads"] == 0'

# No stale picture stays where a run goes on or a film is made anew.
exits 'a run with a checkpoint' 0 run tiny.json --out stale --frames 4 \
    --checkpoint-every 2 --no-obj
exits 'its film' 0 render stale --width 16 --height 16 --samples 1
exits 'its picture' 0 render stale --frame 4 --width 16 --height 16 --samples 1
is 'is where the tool says, too' sh -c '[ "$(cat out)" = \
    stale/pictures/frame_0004.png ] && [ -s "$(cat out)" ]'
: >stale/film.mp4
: >stale/pictures/film_0099.png
exits 'a shorter film' 0 render stale --every 2 --width 16 --height 16 \
    --samples 1 --no-film
is 'of its own pictures alone' sh -c '[ "$(cd stale/pictures && echo *)" = \
    "film_0000.png film_0001.png film_0002.png frame_0004.png" ] &&
    [ ! -e stale/film.mp4 ]'
exits 'the run goes on' 0 run tiny.json --out stale --frames 6 --no-obj \
    --resume stale/checkpoint.drape
is 'without the film of before' sh -c '[ "$(cd stale/pictures && echo *)" = \
    "frame_0004.png" ]'
mkdir -p pictures_only/pictures
cp stale/pictures/frame_0004.png pictures_only/pictures
refused 'a folder of pictures' 'pictures_only: holds a run' \
    run tiny.json --out pictures_only
