# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# What a scene says of its look is seen in its pictures.
# Read by tests/app.sh, whose functions it calls.

# shot NAME CAMERA CLOTH OBSTACLE: a picture of a sheet over a ball on a floor
shot() {
    cat >"$1.json" <<END
{"frames": 0, "camera": {$2},
 "cloths": [{"particles": [21, 21], "size": [1, 1], "start": {"at": [0, 1, 0]},
   "holes": [{"disc": [0.5, 0.5, 0.2]}], "look": {$3}}],
 "obstacles": [{"shape": "plane", "extent": [4, 1, 4], "at": [0, -0.1, 0]},
   {"shape": "sphere", "radius": 0.3, "at": [0, 0.3, 0], "look": {$4}}]}
END
    exits "a run: $1" 0 run "$1.json" --out "look_$1" --quiet
    exits "a picture: $1" 0 render "look_$1" --frame 0 --width 64 --height 48 \
        --samples 4 --quiet
    cp "look_$1/pictures/frame_0000.png" "$1.png"
}
# differ A B: two pictures are not the same
differ() { is "pictures differ: $1, $2" sh -c '! cmp -s "$0.png" "$1.png"' "$1" "$2"; }
eye='"eye": [1.5, 2, 2.5], "target": [0, 0.5, 0]'
shot plain "$eye" '' ''
shot told "$eye, \"fov\": 35, \"light\": 1, \"turn\": 0" '"check": true' ''
is 'the defaults are the defaults' cmp plain.png told.png
shot blue "$eye" '"colour": [0, 0, 1], "check": false' ''
shot even "$eye" '"check": false' ''
shot inside "$eye" '"inside": [0, 1, 0]' ''
shot ball "$eye" '' '"colour": [1, 0, 0], "gloss": 1'
shot glossy "$eye" '' '"gloss": 1'
shot floor "$eye, \"floor\": [0, 0.2, 0]" '' ''
shot sun "$eye, \"sun\": [1, 0.2, 0]" '' ''
shot sun_x "$eye, \"sun\": [2, 0, 0]" '' ''
shot sun_y "$eye, \"sun\": [0, 2, 0]" '' ''
shot sun_z "$eye, \"sun\": [0, 0, 2]" '' ''
shot dim "$eye, \"light\": 0.2" '' ''
shot around '' '' ''
for other in blue even inside ball glossy floor sun sun_x sun_y sun_z dim around; do
    differ plain $other
done
front='"eye": [0, 0.3, 3], "target": [0, 0.3, 0]'
shot east "$front, \"sun\": [1, 0.2, 0]" '' ''
shot west "$front, \"sun\": [-1, 0.2, 0]" '' ''
is 'colours and light are those that were said' python3 "$root/tests/app/png.py" \
    plain.png blue.png floor.png dim.png east.png west.png
printf '{"frames": 0, "cloths": [{"look": {"colour": [0, 2, 0]}}]}' >bad.json
refused 'a colour out of range' '$.cloths[0].look.colour[1]: 2' run bad.json

# A turntable, and a camera that goes round during a film.
exits 'a turntable' 0 render look_plain --turn 4 --width 64 --height 48 \
    --samples 4 --no-film --quiet
is 'of four pictures, the first straight on' sh -c \
    'cmp look_plain/pictures/film_0000.png plain.png &&
    [ "$(ls look_plain/pictures/film_* | wc -l)" -eq 4 ] &&
    ! cmp -s look_plain/pictures/film_0001.png look_plain/pictures/film_0003.png'
sed 's/"frames": 0/"frames": 2, "gravity": [0, 0, 0]/; s/"camera": {/&"turn": 600, /' \
    plain.json >look_turn.json
exits 'a run with a camera that turns' 0 run look_turn.json --out look_turn --quiet
exits 'its film' 0 render look_turn --width 64 --height 48 --samples 4 --no-film --quiet
cp look_turn/pictures/film_0002.png turned.png
sed 's/"turn": 600/"turn": 0/' look_turn/report.json >still.json
cp still.json look_turn/report.json
exits 'a picture that is not turned' 0 render look_turn --frame 2 --width 64 \
    --height 48 --samples 4 --quiet
is 'begins as it is, and turns' sh -c 'cmp look_turn/pictures/film_0000.png plain.png &&
    ! cmp -s look_turn/pictures/frame_0002.png turned.png'
# The second of four pictures around is that of a camera that turns by 90 degrees.
exits 'around, at frame 2' 0 render look_turn --frame 2 --turn 4 --width 64 \
    --height 48 --samples 4 --no-film --quiet
cp look_turn/pictures/film_0001.png around_1.png
exits 'around, at the last frame' 0 render look_turn --turn 4 --width 64 \
    --height 48 --samples 4 --no-film --quiet
is 'is the same' cmp look_turn/pictures/film_0001.png around_1.png
sed 's/"turn": 0/"turn": 2700/' still.json >look_turn/report.json
exits 'a camera that turns by 2700 degrees a second' 0 render look_turn --frame 2 \
    --width 64 --height 48 --samples 4 --quiet
is 'has turned by 90 after two frames' cmp look_turn/pictures/frame_0002.png around_1.png
sed 's/"gloss": 1,/"gloss": 7,/' look_ball/report.json >wrong.json
cp wrong.json look_ball/report.json
refused 'a report with a look that no run writes' 'and a look' render look_ball
sed 's/"check": true/"gloss": 7, "check": true/' look_plain/report.json >wrong.json
cp look_plain/report.json right.json
cp wrong.json look_plain/report.json
refused 'a report with a cloth whose look no run writes' \
    "\$.bodies[0]: expected a cloth's first_vertex, particles and size, and a look" \
    render look_plain
cp right.json look_plain/report.json
sed 's/"light": 1/"light": 11/' look_plain/report.json >wrong.json
cp wrong.json look_plain/report.json
refused 'a report with a light that no run writes' '$.picture: expected fov' \
    render look_plain

# Without a report a cloth is red without a check, as if it had no size, and an
# obstacle is stone.
exits 'a run to lose its report' 0 run tiny.json --out bare --frames 0 --quiet
sed -i 's/"size": \[[^]]*\]/"size": [0, 0]/' bare/report.json
exits 'a picture of a cloth without a size' 0 render bare --frame 0 --width 64 \
    --height 48 --samples 4 --quiet
cp bare/pictures/frame_0000.png sizeless.png
rm bare/report.json
exits 'a picture without a report' 0 render bare --frame 0 --width 64 --height 48 \
    --samples 4 --quiet
is 'is the same' cmp bare/pictures/frame_0000.png sizeless.png

# Small pictures, drawn anew by a program of their own: cloths with a hole and with
# a look, round and level obstacles; a camera that turns, and the tool's own.
# drawn NAME FRAME SAMPLES FLOOR CAMERA
drawn() {
    python3 "$root/tests/app/ray.py" write "$1.json" "{\"camera\": {$5}}" "{$4}"
    exits "a run: $1" 0 run "$1.json" --out "$1" --quiet
    exits "a picture: $1" 0 render "$1" --frame "$2" --width 20 --height 16 \
        --samples "$3" --quiet
    is "$1: every pixel is as another program draws it" \
        python3 "$root/tests/app/ray.py" check "$1" "$2" "$1/pictures/frame_000$2.png" "$3"
}
drawn drawn_turned 1 1 '"shape": "plane", "extent": [4, 1, 4]' \
    '"eye": [1.2, 1.6, 2.3], "target": [0, 0.35, 0], "turn": 600, "fov": 50'
drawn drawn_around 0 2 '"mesh": "floor.off"' \
    '"sun": [1, 0.6, 0.4], "light": 0.7, "floor": [0.3, 0.6, 0.7], "fov": 45'
drawn drawn_near 0 1 '"mesh": "floor.off"' \
    '"eye": [0.75, 1.4, 0.25], "target": [0.7, 0.5, 0.2], "fov": 45'
# A small scene without a floor, by the tool's own camera.
sed 's/"frames": 6/"frames": 0/; s/"cloth", /&"look": {}, /' tiny.json >drawn_small.json
exits 'a run: drawn_small' 0 run drawn_small.json --out drawn_small --quiet
exits 'a picture: drawn_small' 0 render drawn_small --frame 0 --width 20 --height 16 \
    --samples 1 --quiet
is 'drawn_small: every pixel is as another program draws it' \
    python3 "$root/tests/app/ray.py" check drawn_small 0 drawn_small/pictures/frame_0000.png 1
