# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# The commands that read and write frames, meshes and pictures.
# Read by tests/app.sh, whose functions it calls.

# audit, convert, ccd, render
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.2 -1\nv 0.2 0.2 1\nv 0.9 0.9 0\n' >x.obj
printf 'f 1 2 3\nf 4 5 6\n' >>x.obj
exits 'audit finds a pair' 1 audit x.obj --list
is 'audit counts it' grep -q '1 intersecting pairs' out
is 'audit lists it' grep -qx '0 1' out
exits 'audit of one against another' 1 audit good.ply x.obj
awk '$1 == "v" { $3 += 9 } 1' x.obj >apart.obj
exits 'an obstacle is not audited by itself' 0 audit good.ply --obstacle apart.obj
is 'but counted' grep -qx 'good.ply: 3 triangles, 0 intersecting pairs' out
exits 'two meshes are, each by itself' 1 audit good.ply apart.obj --list
is 'and called all' test "$(tr '\n' ' ' <out)" = \
    'all: 3 triangles, 1 intersecting pairs 1 2 '
exits 'an obstacle against a mesh' 1 audit good.ply --obstacle x.obj --list
is 'without its own pair' sh -c 'sed 1d out | grep -q "^0 " &&
    ! sed 1d out | grep -v "^0 "'
exits 'audit of a triangle without area' 0 audit flat.obj
is 'tells it' grep -qx \
    'flat.obj: 2 triangles, 0 intersecting pairs, 1 degenerate triangles' out
refused 'audit of no mesh' 'expected MESH' audit --list
exits 'a run that intersects from the start' 1 run start.json --out crossed \
    --allow-intersecting --frames 3
exits 'its audit' 1 audit crossed --list
is 'is that of its frames' test "$(tail -n 1 out)" = "$(
    for k in 0 1 2 3; do
        "$drape" audit crossed/frames/cloth_000$k.ply --obstacle crossed/obstacles.ply
    done | awk '{ bad += ($4 > 0); sum += $4 } END { print "crossed: 4 frames, " bad \
        " of them with intersecting pairs, " sum " pairs" }')"
is 'and lists them' test "$(grep -c '^[0-9]* [0-9]*$' out)" = "$(
    tail -n 1 out | sed 's/.*, \(.*\) pairs/\1/')"
refused 'audit of nothing' 'nowhere.ply' audit nowhere.ply
refused 'audit of no run' 'frames' audit .
exits 'convert' 0 convert x.obj x.ply --up 0,0,1 --size 2
exits 'convert keeps the pair' 1 audit x.ply
for up in 0,0,0 0,1 0,1,0,0 0,1,0x up; do
    refused "convert up $up" "--up $up: expected X,Y,Z, not zero" \
        convert x.obj refused.ply --up $up
done
for size in 0 -1 1e6 2m m nan; do
    refused "convert to $size m" "--size $size: expected metres above 0" \
        convert x.obj refused.ply --size $size
done
exits 'convert to nearly 1000 km' 0 convert x.obj y.ply --size 999999
"$drape" convert x.obj x_2.obj --quiet
refused 'convert of one mesh' 'expected IN and OUT' convert x.obj
"$drape" convert x.obj y.ply --quiet
exits 'convert up +y' 0 convert x.obj z.ply --up 0,5,0
is 'leaves it' cmp y.ply z.ply
exits 'convert up -y' 0 convert x.obj z.ply --up 0,-0.1,0
is 'turns it about x' python3 -c '
from geometry import load
a, b = (load(path, "f")[0] for path in ("y.ply", "z.ply"))
top = max(p[1] for p in a)
assert all(abs(q[0] - p[0]) + abs(q[1] - (top - p[1])) + abs(q[2] + p[2]) < 1e-6
           for p, q in zip(a, b))'
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
refused 'ccd of nothing' 'is empty' ccd --kind vf none.csv
long=100000000000000000000000000000000000000000
sed "5s/.*/$long,4$(echo $long | cut -c2-),1,4,-1,1/" hit.csv >long.csv
exits 'ccd of long rationals' 0 ccd --kind vf long.csv
is 'the same answer' awk '{ exit !($1 == 1 && $2 > 0.49) }' out
refused 'ccd without kind' '--kind' ccd hit.csv
head -n 8 good.ply >before.ply
sed -i 's/vertex 3/vertex 6/; s/face 1/face 2/' before.ply
cp before.ply after.ply
# A triangle falls through the middle of a horizontal triangle.
for z in 1 -1; do
    file=before.ply
    [ $z = 1 ] || file=after.ply
    printf '%s\n' 'end_header' '0 0 0' '4 0 0' '0 4 0' \
        "1 1 $z" "1 2 $((z + 9))" "2 1 $((z + 9))" '3 0 1 2' '3 3 4 5' >>$file
done
exits 'ccd of two frames' 0 ccd --frames before.ply after.ply
is 'of its candidates one touches' \
    grep -qx '[1-9][0-9]* vf and [0-9]* ee candidates, 1 touch' err
is 'the vertex that falls through' test "$(cat out)" = 'vf 3 0 1 2'
exits 'ccd of a mesh at rest' 0 ccd --frames before.ply before.ply
is 'nothing touches' test ! -s out
refused 'ccd of one frame' 'two meshes' ccd --frames before.ply
refused 'ccd of two meshes' 'good.ply' ccd --frames before.ply good.ply
# Pairs come in any order of their vertices; each has one normal form.
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
frames=${DRAPE_DATA:-$root/build/data}/ccd/frames/cloth-funnel
if [ -e "$frames/hits.txt" ]; then
    exits 'ccd of cloth-funnel' 0 ccd --frames "$frames/t0.ply" "$frames/t1.ply"
    pairs <out >got.txt
    pairs <"$frames/hits.txt" >expected.txt
    is 'all its 134 pairs, and no other' cmp got.txt expected.txt
else
    skip 'ccd of cloth-funnel: no ccd/frames in DRAPE_DATA (sh ci/data.sh DIR fetches it)'
fi
exits 'render' 0 render 'an out' --frame 6 --width 64 --height 48 --samples 1
cp 'an out/pictures/frame_0006.png' once.png
exits 'render again' 0 render 'an out' --frame 6 --width 64 --height 48 \
    --samples 1
is 'the same picture' cmp once.png 'an out/pictures/frame_0006.png'
# size NAME WIDTH HEIGHT OPTIONS...: a picture of this size
size() {
    name=$1 width=$2 height=$3
    shift 3
    exits "$name" 0 render 'an out' --frame 6 --samples 1 "$@"
    is "$name: $width × $height" python3 -c '
import struct, sys
with open("an out/pictures/frame_0006.png", "rb") as file:
    assert struct.unpack(">II", file.read(24)[16:]) == (
        int(sys.argv[1]), int(sys.argv[2]))' $width $height
}
size 'a low picture' 800 16 --height 16
size 'a narrow picture' 16 600 --width 16
for samples in '' '--samples 8'; do
    # shellcheck disable=SC2086
    exits "a picture $samples" 0 render 'an out' --frame 6 --width 24 --height 16 \
        $samples
    cp 'an out/pictures/frame_0006.png' "samples$samples.png"
done
is 'eight samples a pixel, if none is told' cmp samples.png 'samples--samples 8.png'
for threads in 1 2 7 256; do # of 48 rows
    exits "render, threads: $threads" 0 render 'an out' --frame 6 --width 64 \
        --height 48 --samples 1 --threads $threads
    is "the same picture, threads: $threads" cmp once.png \
        'an out/pictures/frame_0006.png'
done
refused 'render of no frame' 'last frame' render 'an out' --frame 7
refused 'render of no run' 'frames' render .
refused 'render of no folder' 'nowhere: no such folder' render nowhere
exits 'render of a run without obstacles' 0 render alone --width 16 --height 16 \
    --samples 1 --frame 0
is 'OBJ says its unit' sh -c 'for file in "an out/frames/cloth_0006.obj" x_2.obj; do
    head -n 1 "$file" | grep -qx "# drape, metres" || exit 1; done'
is 'whose threads are its own, not OpenMP'"'"'s' sh -c \
    'nm -D "$0" >symbols && grep -q pthread_create symbols &&
    ! grep -E "GOMP|kmpc|omp_" symbols' "$drape"
exits 'film' 0 render 'an out' --width 64 --height 48 --samples 1
mkdir no_ffmpeg
env PATH="$work/no_ffmpeg" "$drape" render 'an out' --width 16 --height 16 \
    --samples 1 >out 2>err
is 'a film without ffmpeg' test $? -eq 0
is 'is its pictures, and a word' grep -q 'no ffmpeg here.* in an out/pictures' err
is 'film or a word' sh -c 'test -s "an out/film.mp4" || grep -q ffmpeg err'
exits 'plan' 0 plan tiny.json
is 'its sum is of its stages, and less than what is held' awk '
    match($0, / (on|off) +[0-9]+ /) { split(substr($0, RSTART), part); sum += part[2] }
    $1 == "sum" { told = $2 }
    $1 == "held" { held = $2 } END { exit !(0 < sum && sum == told && told < held) }' out
is 'and those of the report' python3 -c '
import json, re
text = open("out").read().split("\n\n")[1]
rows = re.findall(r"^(\S.*?)  +(on|off) +\d+  (.*)$", text, re.M)
told = json.load(open("an out/report.json"))["plan"]
assert len(told) > 20 and text.startswith("stage ")
assert rows == [(r["stage"], "on" if r["on"] else "off", r["why"]) for r in told]'
is 'plan says on and off' sh -c 'grep -q " on " out && grep -q " off " out'
is 'and what a step takes, and where it was measured' sh -c \
    'sed -n "/^estimate/,\$p" out | grep -q "^NVIDIA H100  .* gpu, binary32"'
# tiny.json has 81 particles: 0.5 + 2 · 81, and 3 + 10 · 81 and 100 times its
# contacts, of which there are 8.1 and 81.
{
    echo names
    echo 'a machine,ref,2000-01-01,2,64,0.5,2e6,3,10e6,100e6,0.25,4,7'
} >speed.csv
exits 'plan by measured constants' 0 plan tiny.json --speed speed.csv
is 'a sum of a constant, particles and contacts' test "$(tail -n 1 out |
    tr -s ' ')" = 'a machine 162 1623 8913 0.25 to 4 ref, binary64, 2 threads, 2000-01-01'
scene explicit.json ', "integrator": "euler"}'
exits 'plan of an explicit integrator' 0 plan explicit.json
is 'it has no estimate' sh -c 'grep -q "not estimated for an explicit" out &&
    ! grep -q machine out'
awk 'BEGIN { print "names"; for (k = 1; k <= 32; k++) print "machine " k \
    ",gpu,2001-02-03," (k % 3) ",32," (97 + k) ",0,40,1e6,2e6,0.5,2,9" }' >32.csv
exits 'plan by 32 machines' 0 plan tiny.json --speed 32.csv
is 'of one thread, of more, and of none that is told' sh -c '
    grep -q "^machine 1 .* gpu, binary32, 1 thread, 2001-02-03$" out &&
    grep -q "^machine 2 .* gpu, binary32, 2 threads, 2001" out &&
    grep -q "^machine 3 .* gpu, binary32, 2001" out'
is 'milliseconds have three digits, and all before the point' sh -c '
    grep -q "^machine 2  *99  *137  *283 " out && grep -q "^machine 3  *100 " out &&
    sed "s/,40,1e6,/,0.04,123,/" 32.csv >small.csv &&
    "$0" plan tiny.json --speed small.csv |
        grep -q "^machine 1  *98  *16.2  *162 "' "$drape"
printf '%s' "$(tail -n 1 32.csv)" >>32.csv
refused 'constants of 33 machines' '32.csv: line 34: more rows than can be read' \
    plan tiny.json --speed 32.csv
printf 'names\n%s' "$(tail -n 1 speed.csv)" >end.csv
exits 'constants whose last line has no end' 0 plan tiny.json --speed end.csv
{
    cat speed.csv
    echo 'a machine,ref,2000-01-01,2,64,0.5,2e6'
} >bad.csv
sed 's/$/x/' speed.csv >long.csv
refused 'constants with a letter behind them' 'long.csv: line 2: expected a row' \
    plan tiny.json --speed long.csv
refused 'constants that are none' 'bad.csv: line 3: expected a row' \
    plan tiny.json --speed bad.csv
: >empty.csv
refused 'constants of no machine' 'empty.csv: no row of a machine' \
    plan tiny.json --speed empty.csv

# Ranges and defaults in the documents agree with the code.
line=$(python3 "$root/tests/defaults.py" "$drape" \
    "$root/app/scenes/README.md" | tee defaults | tail -n 1)
grep '^not ok' defaults
passed=$((passed + ${line%% *}))
failed=$((failed + $(echo "$line" | cut -d' ' -f3)))

for json in "$root"/app/scenes/*.json; do
    name=$(basename "$json" .json)
    case $name in
    buddha* | lion* | dragon*) continue ;; # their statues may not be here
    esac
    exits "scene $name" 0 plan "$json"
done

# The commands that are Python's: a wrong command line is told first; then
# without Python, and without the package.
for wrong in view 'view a b' 'view a --port=x' export 'export a' \
    'export a --to x.usdc --every 0' 'export a --for b'; do
    # shellcheck disable=SC2086
    env PATH=/nowhere "$drape" $wrong >out 2>err
    is "$wrong: a wrong command line" test $? -eq 2
    is "$wrong: no word of Python" sh -c '! grep -i python err'
done
env PATH=/nowhere "$drape" view 2>err
is 'view: what is missing' grep -q '^drape: view: expected one DIR' err
fails 'export without Python' 'export: python3 cannot be started' \
    env PATH=/nowhere "$drape" export 'an out' --to x.usdc
fails 'sew of a mesh without Python' 'drape: sew: python3 cannot be started' \
    env PATH=/nowhere "$drape" sew a.obj
# A Python that writes down how it is called: the package gets all words but those
# that are the tool's.
mkdir words
printf '%s\n' '#!/bin/sh' '[ "$1" = -c ] && shift 2 && printf "%s\n" "$@" >words/said' \
    >words/python3
chmod +x words/python3
# passed_on EXPECTED ARGUMENTS...
passed_on() {
    expected=$1
    shift
    : >words/said
    PATH="$PWD/words:$PATH" "$drape" "$@" >out 2>err
    is "$* is passed on" test "$(tr '\n' ' ' <words/said)" = "$expected "
}
passed_on 'view a' view a
passed_on 'view --port 0 a --host b' view --port 0 a --host b
passed_on 'view --quiet a --port=65535' --quiet view a --port=65535
passed_on 'export a --to b --every 1000000' export a --to b --every 1000000
refused 'a port that is none' '--port 65536: expected a whole number from 0 to 65535' \
    view a --port 65536
mkdir no_package no_package/drape
printf '#!/bin/sh\nexec %s -S -E "$@"\n' "$(command -v python3)" \
    >no_package/python3
chmod +x no_package/python3
fails 'view without the package' 'view: python3 cannot import the package' \
    env PATH="$work/no_package:$PATH" "$drape" view 'an out'
is 'and the line that is missing' grep -qF \
    'make venv, then build/venv/bin/drape view' err
fails 'sew of a mesh without the package' \
    'drape: sew: python3 cannot import the package' \
    env PATH="$work/no_package:$PATH" "$drape" sew a.obj
is 'and its line that is missing' grep -qE \
    'make venv, then build/venv/bin/drape sew$' err
