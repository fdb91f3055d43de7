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
exits 'options after -- are names' 2 run -- --frames
exits 'the beginning of one option' 0 run tiny.json --fram 1 --out begun
refused 'the beginning of two' '--f: is the beginning of 2 options' \
    run tiny.json --f 1 --out refused
refused 'a value for a flag' '--force=1: takes no value' \
    run tiny.json --force=1 --out refused
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

# A film that ffmpeg begins and breaks off leaves nothing behind.
mkdir broken
printf '%s\n' '#!/bin/sh' 'for last; do :; done' 'echo half >"$last"' 'exit 1' \
    >broken/ffmpeg
chmod +x broken/ffmpeg
is 'no part of a film is left' sh -c '
    PATH="$PWD/broken:$PATH" "$0" render still --width 16 --height 16 \
        --samples 1 --quiet 2>err
    [ $? -eq 3 ] && grep -q "ffmpeg failed on still/film.mp4" err &&
    [ ! -e still/film.mp4 ] && [ ! -e still/.film.part.mp4 ]' "$drape"

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
    is "the same mesh by .$end" python3 "$root/tests/app/mesh.py" quiet.ply \
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
