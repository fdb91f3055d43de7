#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The tool's answers to good and bad input.
# usage: tests/app.sh DRAPE; ends with `N passed, N failed, N skipped`.
set -u
drape=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
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
# text, nothing on stdout, and no directory `refused` comes to be.
refused() {
    name=$1 text=$2
    shift 2
    rm -rf refused
    "$drape" "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq 2 ] && [ ! -s out ] && [ "$(wc -l <err)" -eq 1 ] &&
        grep -qF -- "$text" err && [ ! -e refused ]; then
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

# ---- help and exit codes ----
exits 'help' 0 help
is 'help names every command' sh -c 'for c in run plan audit render ccd \
    convert info help; do grep -q "^  $c " out || exit 1; done'
for command in run plan audit render ccd convert info help; do
    exits "help $command" 0 help $command
    is "help $command shows its usage" grep -q "usage: drape $command" out
done
# Every option in a command's table is in its help and in the manual.
for command in run plan audit render ccd convert; do
    "$drape" help $command >out
    sed 's/\\-/-/g' "$root/app/drape.1" >manual
    options=$(sed -n 's/.*{"\(--[a-z-]*\)", OPTION.*/\1/p' \
        "$root/app/$command.c")
    is "$command has options" test -n "$options"
    for o in $options; do
        is "help and manual have $command $o" sh -c \
            'grep -qe "$1" out && grep -qe "$1" manual' sh "$o"
    done
done
exits 'run --help' 0 run --help
exits 'info' 0 info
exits 'no command' 2
refused 'unknown command' 'frobnicate' frobnicate
refused 'unknown option' '--frob' run tiny.json --frob
refused 'option without value' '--frames' run tiny.json --frames
refused 'option out of range' '--frames' run tiny.json --frames -1
refused 'option no number' '--threads' run tiny.json --threads two
refused 'no scene' 'expected one' run
refused 'two scenes' 'expected one' run tiny.json tiny.json
refused 'precision 33' 'precision' run tiny.json --precision 33 --out refused
refused 'unknown backend' '--backend' run tiny.json --backend abacus

# ---- scenes ----
printf '{"frames": 3,\n "cloths": [}\n' >broken.json
refused 'malformed JSON, by line' 'broken.json: line 2' run broken.json
: >empty.json
refused 'empty scene' 'empty.json: line 1' run empty.json
printf '[1]' >list.json
refused 'scene is a list' 'expected an object' run list.json
printf '{}' >bare.json
refused 'no cloth' 'cloths' run bare.json
refused 'missing scene' 'nowhere.json' run nowhere.json
refused 'scene is a directory' 'directory' run .
scene key.json ', "gravityy": [0, 0, 0]}'
refused 'unknown key, by name' '"gravityy"' run key.json --out refused
scene key.json ', "wind": {"speed": 3}}'
refused 'unknown key, by path' '$.wind' run key.json --out refused
scene key.json ', "frames": 5}'
refused 'key twice' 'twice' run key.json --out refused
scene key.json ', "dt": "fast"}'
refused 'wrong type' '$.dt: expected a number' run key.json --out refused
scene key.json ', "dt": -1}'
refused 'out of range' '$.dt: -1' run key.json --out refused
scene key.json ', "dt": 1e999}'
refused 'number overflows' '$.dt' run key.json --out refused
scene key.json ', "gravity": [0, 1]}'
refused 'short vector' '$.gravity: expected a list of 3' run key.json
scene key.json ', "gravity": [0, 1, null]}'
refused 'vector of null' '$.gravity[2]' run key.json
scene key.json ', "integrator": "magic"}'
refused 'unknown choice' '"choi-ko"' run key.json
scene key.json ', "precision": 48}'
refused 'precision 48' 'precision' run key.json
scene key.json ', "motions": [{"name": "a", "keys": []}]}'
refused 'motion without keys' '$.motions[0]' run key.json
sed 's/\[9, 9\]/[40000, 9]/' tiny.json >big.json
refused 'cloth beyond 32768' '$.cloths[0].particles[0]' run big.json
sed 's/\[9, 9\]/[32768, 32768]/' tiny.json >big.json
refused 'cloth beyond the memory' 'memory' run big.json --out refused
scene key.json ', "memory": 0.001}'
sed 's/\[9, 9\]/[900, 900]/' key.json >big.json
refused 'memory limit' 'memory limit' run big.json --out refused
sed 's/\[9, 9\]/[29, 29]/' key.json >big.json
exits 'no memory for a step' 3 run big.json --out short
is 'what was done is reported' grep -q '"end": "failed"' short/report.json
is 'and its frames are there' test -s short/cloth.pc2
sed 's/\[9, 9\]/[9.5, 9]/' tiny.json >key.json
refused 'half a particle' 'whole' run key.json
sed 's/"at": \[0, 0.36, 0\]/"at": [0, 0.2, 0]/' tiny.json >start.json
refused 'start that intersects, with its count' 'intersect' \
    run start.json --out refused
is 'the count is there' grep -q '[1-9][0-9]*' err
exits 'start that intersects, allowed' 0 plan start.json --allow-intersecting
sed 's/"thickness": 0.01/"thickness": 0/' tiny.json >key.json
refused 'thickness 0' 'thickness' run key.json --out refused

# ---- meshes ----
obstacle nowhere.obj
refused 'missing mesh' 'nowhere.obj' run mesh.json --out refused
for end in ply obj off stl gltf; do
    : >empty.$end
    obstacle empty.$end
    refused "empty $end" "empty.$end" run mesh.json --out refused
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' >points.obj
obstacle points.obj
refused 'points only' 'points.obj' run mesh.json --out refused
printf 'v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n' >nan.obj
obstacle nan.obj
refused 'NaN in OBJ' 'not finite' run mesh.json --out refused
head='ply\nformat ascii 1.0\nelement vertex 3\nproperty double x
property double y\nproperty double z\nelement face 1
property list uchar int vertex_indices\nend_header\n'
# shellcheck disable=SC2059
{
    printf "${head}0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n" >inf.ply
    printf "${head}0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n" >index.ply
    printf "${head}0 0 0\n1 0 0\n0 1\n" >short.ply
    printf "${head}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" >good.ply
}
obstacle inf.ply
refused 'infinity in PLY' 'not finite' run mesh.json --out refused
obstacle index.ply
refused 'index out of range' 'vertex 7' run mesh.json --out refused
obstacle short.ply
refused 'PLY that ends early' 'short.ply' run mesh.json --out refused
printf 'ply\nformat martian 1.0\nend_header\n' >format.ply
obstacle format.ply
refused 'PLY of no format, by line' 'line 2' run mesh.json --out refused
obstacle good.ply
exits 'good PLY' 0 run mesh.json --out good
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n' >flat.obj
obstacle flat.obj
exits 'degenerate faces are accepted' 0 run mesh.json --out flat
is 'and reported' grep -q '1 triangles without area' err
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n' \
    >fins.obj
obstacle fins.obj
exits 'non-manifold obstacle is accepted' 0 run mesh.json --out fins

# ---- a run and what it leaves ----
mkdir 'a path'
cp tiny.json 'a path/my scene.json'
exits 'path with spaces' 0 run 'a path/my scene.json' --out 'an out'
for name in frames/cloth_0006.ply frames/cloth_0006.obj obstacles.ply \
    cloth.pc2 report.json; do
    is "leaves $name" test -s "an out/$name"
done
is 'no part is left' sh -c '! find "an out" -name "*.part" | grep -q .'
is 'report.json is JSON with 6 steps' python3 -c '
import json
r = json.load(open("an out/report.json"))
assert [s["step"] for s in r["steps"]] == [1, 2, 3, 4, 5, 6]
assert r["end"] == "complete" and r["summary"]["steps"] == 6
m = r["memory"]
assert m["host_bytes"] == sum(row["bytes"] for row in r["plan"]) > 0
assert 0 < m["host_bytes"] < r["held_bytes"] and m["device_bytes"] == 0'
is 'cloth.pc2 holds all frames' python3 -c '
import struct
d = open("an out/cloth.pc2", "rb").read()
assert struct.unpack("<12siiffi", d[:32]) == (
    b"POINTCACHE2\0", 1, 81, 0.0, 1.0, 7)
assert len(d) == 32 + 7 * 81 * 12
p = open("an out/frames/cloth_0006.ply", "rb").read()
p = p[p.index(b"end_header\n") + 11:][:81 * 12]
assert d[-81 * 12:] == p'
exits 'every second frame' 0 run tiny.json --out second --every 2
is 'frames 0, 2, 4, 6' sh -c 'cd second/frames && [ "$(echo *.ply)" = \
    "cloth_0000.ply cloth_0002.ply cloth_0004.ply cloth_0006.ply" ]'
is 'the same frame' cmp second/frames/cloth_0004.ply \
    'an out/frames/cloth_0004.ply'
is 'cloth.pc2 holds those, two frames apart' python3 -c '
import struct
head = open("second/cloth.pc2", "rb").read(32)
assert struct.unpack("<12siiffi", head)[2:] == (81, 0.0, 2.0, 4)'
exits 'audit of every second frame' 0 audit second
is 'audit counts those that are there' grep -q '4 frames, 0 of them' out
exits 'picture of a kept frame' 0 render second --frame 4 --width 64 \
    --height 48 --samples 1
refused 'picture of a frame that was left out' 'last frame is 6' \
    render second --frame 3
exits 'film of what is there' 0 render second --width 64 --height 48 \
    --samples 1 --no-film
is 'four pictures' grep -q ': 4 pictures' out
exits 'all frames over those' 0 run tiny.json --out second --frames 1
is 'nothing of the run before is left' sh -c 'cd second/frames &&
    [ "$(echo *)" = "cloth_0000.obj cloth_0000.ply cloth_0001.obj \
cloth_0001.ply" ]'
exits 'audit of the run' 0 audit 'an out'
is 'audit says 0 pairs' grep -q '7 frames, 0 of them .*, 0 pairs' out
exits '64 bits' 0 run tiny.json --out wide --precision 64
is '64 bits writes doubles' grep -aq 'property double x' wide/obstacles.ply
exits 'trace' 0 run tiny.json --out traced --trace
is 'trace has stages' grep -q '^1,[a-z]' traced/trace.csv
for threads in 1 3; do
    exits "$threads threads" 0 run tiny.json --out t$threads \
        --threads $threads
done
is 'same bits for 1 and 3 threads' cmp t1/cloth.pc2 t3/cloth.pc2
is 'output to a pipe: plain lines' sh -c \
    '"$0" run tiny.json --out piped 2>&1 | grep -q "step 6/6"' "$drape"
is 'no carriage return in a pipe' sh -c \
    '! "$0" run tiny.json --out piped 2>&1 | grep -q "$(printf "\r")"' "$drape"
exits '--error' 0 run tiny.json --out near --frames 6 --error 0.004
is '--error chooses shorter steps and says its estimate' python3 -c '
import json
r = json.load(open("near/report.json"))
assert r["dt"] < 1 / 61 and 0 < r["error"]["estimated"] <= 0.004
assert abs(r["dt"] * r["steps_per_frame"] - 1 / 60) < 1e-12
assert len(r["steps"]) == 6 * r["steps_per_frame"]'
refused '--error of no number' '--error' run tiny.json --error small
refused '--error of 0' '--error' run tiny.json --error 0
refused '--error and --resume' '--error' \
    run tiny.json --error 1 --resume half/checkpoint.drape

# ---- checkpoints ----
exits 'checkpoint' 0 run tiny.json --out half --frames 4 --checkpoint-every 4
exits 'resume' 0 run tiny.json --out half --resume half/checkpoint.drape
is 'resumed equals unbroken' cmp half/cloth.pc2 'an out/cloth.pc2'
is 'report has all steps' python3 -c '
import json
r = json.load(open("half/report.json"))
assert [s["step"] for s in r["steps"]] == [1, 2, 3, 4, 5, 6]'
refused 'resume from nothing' 'nothing.drape' \
    run tiny.json --out refused --resume nothing.drape
refused 'resume from no checkpoint' 'tiny.json' \
    run tiny.json --out refused --resume tiny.json
head -c 200 half/checkpoint.drape >cut.drape
refused 'resume from a part' 'cut.drape' \
    run tiny.json --out refused --resume cut.drape
sed 's/\[9, 9\]/[8, 8]/' tiny.json >other.json
refused 'resume another scene' 'half/checkpoint.drape' \
    run other.json --out refused --resume half/checkpoint.drape
scene long.json ', "steps_per_frame": 37, "sleep": false}'
"$drape" run long.json --out cut --frames 100000 >out 2>err &
child=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    sleep 0.25
    [ ! -s cut/frames/cloth_0001.ply ] || break
done
kill -INT $child
wait $child
got=$?
if [ $got -eq 130 ]; then ok 'Ctrl-C exits 130'; else bad "Ctrl-C: $got"; fi
is 'Ctrl-C leaves a checkpoint' test -s cut/checkpoint.drape
is 'and the report' grep -q '"end": "interrupted"' cut/report.json
frames=$(python3 -c '
import json
print(len(json.load(open("cut/report.json"))["steps"]) // 37 + 1)')
exits 'resume after Ctrl-C' 0 run long.json --out cut --frames "$frames" \
    --resume cut/checkpoint.drape
exits 'the same unbroken' 0 run long.json --out whole --frames "$frames"
is 'equal bit for bit' cmp cut/cloth.pc2 whole/cloth.pc2

# ---- a full disk ----
if [ -e /dev/full ]; then
    "$drape" help >/dev/full 2>err
    got=$?
    if [ $got -eq 3 ]; then ok 'full stdout'; else bad "full stdout: $got"; fi
else
    skip 'full stdout: no /dev/full here'
fi
# A limit on the size of a file makes write fail as a full disk does.
(
    trap '' XFSZ
    ulimit -f 4
    "$drape" run tiny.json --out full --frames 1 >out 2>err
)
got=$?
if [ $got -eq 3 ] && grep -q 'cannot write' err; then
    ok 'file too large'
else
    bad "file too large (exit $got)"
fi
is 'nothing half-written' sh -c '! find full -name "*.part" | grep -q . &&
    [ ! -e full/report.json ] && [ ! -e full/cloth.pc2 ]'
mkdir disk
if mount -t tmpfs -o size=64k drape disk 2>/dev/null; then
    exits 'full disk' 3 run tiny.json --out disk/run
    is 'full disk, one line' test "$(grep -c 'cannot write' err)" -eq 1
    is 'frames that are there are whole' sh -c '
        for f in disk/run/frames/cloth_*.ply; do
            "$0" audit "$f" >/dev/null || exit 1
        done' "$drape"
    is 'no part on the full disk' sh -c '! find disk -name "*.part" | grep -q .'
    umount disk
else
    skip 'full disk: no right to mount a small one'
fi

# ---- audit, convert, ccd, render ----
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.2 -1\nv 0.2 0.2 1\nv 0.9 0.9 0\n' >x.obj
printf 'f 1 2 3\nf 4 5 6\n' >>x.obj
exits 'audit finds a pair' 1 audit x.obj --list
is 'audit counts it' grep -q '1 intersecting pairs' out
is 'audit lists it' grep -qx '0 1' out
exits 'audit of one against another' 1 audit good.ply x.obj
refused 'audit of nothing' 'nowhere.ply' audit nowhere.ply
refused 'audit of no run' 'frames' audit .
exits 'convert' 0 convert x.obj x.ply --up 0,0,1 --size 2
exits 'convert keeps the pair' 1 audit x.ply
refused 'convert up nowhere' '--up' convert x.obj y.ply --up 0,0,0
row='1,2,0,1,1,4'
for z in 1 0 0 0 -1 0 0 0; do
    case $z in
    1 | -1) echo "1,4,1,4,$z,1" ;;
    *) echo face ;;
    esac
done | awk '$0 == "face" {
    f[0] = "0,1,0,1,0,1"; f[1] = "2,2,0,3,0,1"; f[2] = "0,1,8,8,0,1"
    print f[n++ % 3]; next } { print }' >hit.csv
exits 'ccd touches' 0 ccd --kind vf hit.csv
is 'ccd gives a time up to one half' awk \
    '{ exit !(NF == 2 && $1 == 1 && $2 > 0.49 && $2 <= 0.5) }' out
sed 's/$/,1/' hit.csv >truth.csv
exits 'ccd with its truth' 0 ccd --kind vf truth.csv
is 'ccd says none missed' grep -q '1 queries, 0 missed, 0 invented' err
sed 's/$/,0/' hit.csv >lie.csv
exits 'ccd against a lie' 1 ccd --kind vf lie.csv
{
    sed -n 1,2p hit.csv
    echo "$row,"
} >row.csv
refused 'ccd row, by line' 'line 3' ccd --kind vf row.csv
sed '4s/.*/1,3,0,1,0,1/' hit.csv >third.csv
sed -n 1,3p third.csv >none.csv
refused 'ccd of a third' 'line 4' ccd --kind vf third.csv
refused 'ccd of half a query' 'line 3' ccd --kind vf none.csv
sed '2s/,1,0,1$/,0,0,1/' hit.csv >zero.csv
refused 'ccd of a zero denominator' 'line 2' ccd --kind vf zero.csv
: >none.csv
refused 'ccd of nothing' 'query' ccd --kind vf none.csv
long=100000000000000000000000000000000000000000
sed "5s/.*/$long,4$(echo $long | cut -c2-),1,4,-1,1/" hit.csv >long.csv
exits 'ccd of long rationals' 0 ccd --kind vf long.csv
is 'the same answer' awk '{ exit !($1 == 1 && $2 > 0.49) }' out
refused 'ccd without kind' '--kind' ccd hit.csv
head -n 8 good.ply >before.ply
sed -i 's/vertex 3/vertex 6/; s/face 1/face 2/' before.ply
cp before.ply after.ply
# A triangle falls through the middle of another, flat one.
for z in 1 -1; do
    file=before.ply
    [ $z = 1 ] || file=after.ply
    printf '%s\n' 'end_header' '0 0 0' '4 0 0' '0 4 0' \
        "1 1 $z" "1 2 $((z + 9))" "2 1 $((z + 9))" '3 0 1 2' '3 3 4 5' >>$file
done
exits 'ccd of two frames' 0 ccd --frames before.ply after.ply
is 'the vertex that falls through' test "$(cat out)" = 'vf 3 0 1 2'
exits 'ccd of a mesh at rest' 0 ccd --frames before.ply before.ply
is 'nothing touches' test ! -s out
refused 'ccd of one frame' 'two meshes' ccd --frames before.ply
refused 'ccd of two meshes' 'good.ply' ccd --frames before.ply good.ply
# Pairs in any order of their vertices, one form for each.
pairs() {
    python3 -c '
import sys
for line in sys.stdin:
    kind, *v = line.split()
    v = list(map(int, v))
    w = [v[:1], sorted(v[1:])] if kind == "vf" else sorted(
        [sorted(v[:2]), sorted(v[2:])])
    print(kind, *w[0], *w[1])' | sort
}
frames=$root/../shared/ccd/frames/cloth-funnel
if [ -e "$frames/hits.txt" ]; then
    exits 'ccd of cloth-funnel' 0 ccd --frames "$frames/t0.ply" "$frames/t1.ply"
    pairs <out >got.txt
    pairs <"$frames/hits.txt" >expected.txt
    is 'all its 134 pairs, and no other' cmp got.txt expected.txt
else
    skip 'ccd of cloth-funnel: the frames are not here'
fi
exits 'render' 0 render 'an out' --frame 6 --width 64 --height 48 --samples 1
cp 'an out/pictures/frame_0006.png' once.png
exits 'render again' 0 render 'an out' --frame 6 --width 64 --height 48 \
    --samples 1
is 'the same picture' cmp once.png 'an out/pictures/frame_0006.png'
refused 'render of no frame' 'last frame' render 'an out' --frame 7
refused 'render of no run' 'frames' render .
exits 'film' 0 render 'an out' --width 64 --height 48 --samples 1
is 'film or a word' sh -c 'test -s "an out/film.mp4" || grep -q ffmpeg err'
exits 'plan' 0 plan tiny.json
is 'plan says on and off' sh -c 'grep -q " on " out && grep -q " off " out'

# What is written of ranges and defaults, against what is so.
line=$(python3 "$root/tests/defaults.py" "$drape" \
    "$root/app/scenes/README.md" | tee defaults | tail -n 1)
grep '^not ok' defaults
passed=$((passed + ${line%% *}))
failed=$((failed + $(echo "$line" | cut -d' ' -f3)))

# The tables of the paper's figures, of a scene that takes no time.
is 'runs for the tables' sh -c 'cd "$1" && SCENES=tiny FRAMES=6 SHORT=4 \
    EVERY=2 STEPS=1 THREADS="1 2" BACKEND=ref sh ci/bench/scenes.sh \
    "${2%/*}" "$3/bench"' sh "$root" "$drape" "$work"
is 'tables of them' python3 "$root/ci/bench/tables.py" bench/results tables
is 'steps of frames 5 and 6 by the reference, the same' sh -c \
    '[ "$(cut -d, -f1-4,8 tables/figure12.csv | tr "\n" " ")" = "scene,from \
step,steps,threads,same counts and energies tiny,5,1,1,yes tiny,5,1,2,yes " ]'
is 'the paper beside them' grep -q '^scene.*GTX 680' tables/figure8.csv
is 'plots are XML' python3 -c '
import xml.dom.minidom
for k in range(8, 13):
    xml.dom.minidom.parse("tables/figure%d.svg" % k)'

for json in "$root"/app/scenes/*.json; do
    name=$(basename "$json" .json)
    case $name in
    buddha* | lion* | dragon*) continue ;; # their statues may not be here
    esac
    exits "scene $name" 0 plan "$json"
done

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
