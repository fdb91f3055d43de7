# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2059,SC2154
# A resumed run equals an unbroken run, and checkpoints hold the whole state.
# Read by tests/app.sh, whose functions it calls.

what=$root/tests/app/report.py

# A resumed run
# The scene has two cloths and two obstacles, motions, a trace, and skips frames.
cat >moves.json <<'EOF'
{"name": "moves", "frames": 12, "steps_per_frame": 2,
 "cloths": [
  {"name": "high", "particles": [13, 9], "size": [0.5, 0.4],
   "start": {"at": [0, 0.3, 0]}, "material": {"thickness": 0.01}},
  {"name": "low", "particles": [9, 9], "size": [0.4, 0.4],
   "start": {"at": [0.02, 0.26, 0]}, "material": {"thickness": 0.01}}],
 "motions": [{"name": "lift", "keys": [{"time": 0},
   {"time": 0.1, "move": [0, 0.05, 0]}]}],
 "obstacles": [
  {"name": "ball", "shape": "sphere", "radius": 0.15, "at": [0, 0.08, 0],
   "detail": 10, "motion": "lift"},
  {"name": "floor", "shape": "plane", "extent": [2, 1, 2],
   "at": [0, -0.2, 0]}]}
EOF
exits 'a run with a trace' 0 run moves.json --out u --trace
is 'its summary is the sum of its steps' python3 "$what" sums u
is 'its report describes each body' python3 -c '
import json
r = json.load(open("u/report.json"))
high, low, ball, floor = r["bodies"]
at = [(b["name"], b["kind"], b["first_vertex"]) for b in r["bodies"]]
assert at == [("high", "cloth", 0), ("low", "cloth", 117),
              ("ball", "obstacle", 198), ("floor", "obstacle", at[3][2])], at
assert high["particles"] == [13, 9] and high["size"] == [0.5, 0.4]
assert low["particles"] == [9, 9] and low["size"] == [0.4, 0.4]
assert low["first_triangle"] == 2 * 12 * 8
assert ball["first_triangle"] == 2 * 12 * 8 + 2 * 8 * 8
assert ball["moving"] is True and floor["moving"] is False
assert r["vertices"] == floor["first_vertex"] + 4
assert r["triangles"] == floor["first_triangle"] + 2'
exits 'half of it' 0 run moves.json --out r --trace --frames 7 \
    --checkpoint-every 3
exits 'the rest of it' 0 run moves.json --out r --trace --resume \
    r/checkpoint.drape
is 'which lacks no row of its trace' sh -c '! grep note err'
# A trace that lacks rows: those behind half a row or behind a step that comes late.
exits 'a run to break' 0 run moves.json --out gap --trace --frames 3 --quiet \
    --checkpoint-every 3
for end in '4,predict' '2,predict,0123456789abcdef,1e-6\n' '4;predict,0,0\n' \
    'four,predict,0,0\n'; do
    cp -R gap gaps
    sed '/^4,/,$d' gap/trace.csv >gaps/trace.csv
    printf "$end" >>gaps/trace.csv
    [ "$end" = 4,predict ] || sed -n '/^5,/p' gap/trace.csv >>gaps/trace.csv
    exits "a trace with the row $end" 0 run moves.json --out gaps --trace --frames 4 \
        --resume gaps/checkpoint.drape
    is "has four steps before it, $end" grep -qx \
        'drape: note: gaps/trace.csv has rows of 4 of the 6 steps before' err
    is "and those to come, $end" test "$(cut -d, -f1 gaps/trace.csv | uniq |
        tr '\n' ' ')" = 'step 0 1 2 3 6 7 '
    rm -r gaps
done
sed 's/step,stage/step,state/' gap/trace.csv >head.csv
mv head.csv gap/trace.csv
exits 'a trace with another head' 0 run moves.json --out gap --frames 4 \
    --resume gap/checkpoint.drape
is 'has no step' grep -q 'has rows of 0 of the 6 steps' err
exits 'another folder' 0 run moves.json --out gap2 --frames 4 --trace \
    --resume gap/checkpoint.drape
is 'has none, either' grep -q 'has rows of 0 of the 6 steps' err
is 'and no cache, as it lacks frames' grep -qx \
    'drape: note: no cloth.pc2, because frame 0 is not in gap2/frames' err
# A frame of another scene is found as late as in the cache.
cp good.ply gap/frames/cloth_0001.ply
exits 'a frame of another scene' 3 run moves.json --out gap --frames 4 --quiet \
    --resume gap/checkpoint.drape
is 'is said to be one' grep -q 'cloth_0001.ply: a frame of another scene' err
is 'and leaves no part' sh -c '! find gap -name "*.part" | grep .'
is 'the whole run is the unbroken one' python3 "$what" same u r
exits 'the rest of it again, less far' 0 run moves.json --out r --frames 9 \
    --resume r/checkpoint.drape
exits 'as far, unbroken' 0 run moves.json --out v --frames 9
is 'no frame and no trace is left from further on' sh -c '
    [ ! -e r/frames/cloth_0010.ply ] && [ -e r/frames/cloth_0009.ply ] &&
    grep -q "^11," r/trace.csv && ! grep -q "^12," r/trace.csv &&
    rm r/trace.csv && python3 "$0" same v r' "$what"
exits 'no further than the checkpoint' 0 run moves.json --out r --frames 6 \
    --resume r/checkpoint.drape
is 'no frame from behind it' sh -c \
    '[ "$(cd r/frames && echo cloth_0006* cloth_0007* obstacles_0007*)" = \
    "cloth_0006.ply cloth_0007* obstacles_0007*" ]'
exits 'still obstacles, resumed' 0 run tiny.json --out u2 --frames 3 \
    --checkpoint-every 3
exits 'into another folder' 0 run tiny.json --out r2 --resume \
    u2/checkpoint.drape
exits 'the rest into its own' 0 run tiny.json --out u2 --resume \
    u2/checkpoint.drape
exits 'the same unbroken' 0 run tiny.json --out w2
is 'the whole run is the unbroken one, still' python3 "$what" same w2 u2
is 'the obstacles came along' cmp r2/obstacles.ply w2/obstacles.ply
exits 'audit of a run from a checkpoint' 0 audit r2
exits '--error, cut short' 0 run tiny.json --out near2 --frames 6 \
    --error 0.004 --checkpoint-every 3
exits 'what --error chose holds on' 0 run tiny.json --out near2 --frames 6 \
    --resume near2/checkpoint.drape
is 'and the estimate' python3 "$what" same near near2
scene choi.json ', "integrator": "choi-ko", "tolerance": 1e-5}'
exits '--error of 5 cm' 0 run choi.json --out coarse2 --frames 6 --error 0.05
exits 'the same, cut short' 0 run choi.json --out coarse3 --frames 6 --error 0.05 \
    --checkpoint-every 3
exits 'what it chose holds on, whatever the scene says' 0 run choi.json \
    --out coarse3 --frames 6 --resume coarse3/checkpoint.drape
is 'its integrator is not the scene'"'"'s' grep -q '"integrator": "baraff-witkin"' \
    coarse3/report.json
is 'it is the same run' python3 "$what" same coarse2 coarse3

# A killed run leaves complete files, a report and its trace so far.
scene killed.json ', "steps_per_frame": 11, "sleep": false}'
"$drape" run killed.json --out killed --trace --no-obj --frames 100000 \
    --checkpoint-every 2 >out 2>err &
child=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    sleep 0.25
    [ ! -s killed/checkpoint.drape ] || break
done
is 'a file under way has its writer in its name' sh -c \
    'ls -A killed | grep -q "^[.]trace.csv.$0-[0-9]*[.]part$"' "$child"
kill -9 $child
wait $child 2>/dev/null
is 'killed, it has a report that says so' grep -q '"end": "unfinished"' \
    killed/report.json
exits 'and can be audited' 0 audit killed
exits 'a killed run goes on' 0 run killed.json --out killed --trace --no-obj \
    --frames 400 --every 2 --resume killed/checkpoint.drape
is 'its trace has all steps' sh -c '[ "$(tail -n +2 killed/trace.csv |
    cut -d, -f1 | uniq | wc -l)" -eq 4400 ]'
is 'nothing of the killed writer is left' sh -c \
    '! find killed -name ".*" | grep -q .'

# Checkpoints
exits 'a run of 600 steps' 0 run tiny.json --out 600 --frames 600 --no-obj \
    --every 600 --checkpoint-every 600
is 'every field, sum and range of its report' python3 "$what" rows "$drape" \
    600/checkpoint.drape
is 'no checkpoint with a wrong byte' python3 "$what" damage "$drape" \
    u2/checkpoint.drape
sed 's/^drape run ./drape run 1/' u2/checkpoint.drape >old.drape
refused 'a checkpoint of an older version' 'another version' \
    run tiny.json --out refused --resume old.drape
refused 'a checkpoint that is a folder' 'is a directory' \
    run tiny.json --out refused --resume u2

# Steps that are not clean
cat >storm.json <<'EOF'
{"frames": 20, "integrator": "verlet", "dt": 1e-4,
 "cloths": [{"particles": [21, 21], "size": [1, 1], "pins": [{"edge": "u0"}]}],
 "wind": {"velocity": [100, 0, 100], "density": 1, "drag": 1e3, "lift": 1e3}}
EOF
cat >cross.json <<'EOF'
{"frames": 3, "allow_intersecting": true,
 "cloths": [{"particles": [5, 5]},
  {"particles": [5, 5], "start": {"u": [1, 1, 0]}}]}
EOF
exits 'a run that diverges' 1 run storm.json --out storm
is 'the step that diverged is named, and is not one of those done' python3 -c '
import json, struct
r = json.load(open("storm/report.json"))
done = r["summary"]["steps"]
assert r["end"] == "diverged" and len(r["steps"]) == done + 1
assert "diverged" in r["steps"][-1]["outcome"]
assert r["steps"][-1]["step"] == done and r["summary"]["outcomes"][
    "diverged"] == 1
assert "step %d: diverged" % (done + 1) in open("err").read()
assert "storm: %d steps" % done in open("out").read()
head = struct.unpack("<12siiffi", open("storm/cloth.pc2", "rb").read(32))
assert head[-1] == done + 1 > 1'
exits 'no error that a run keeps which intersects' 1 run cross.json --out refused \
    --error 0.001
is 'which is said' grep -q 'the trial runs intersect or diverge at the finest' err
is 'its summary is the sum of its steps, too' python3 "$what" sums storm

# Names
# A file's name may be any bytes; what is not UTF-8 in it is marked in a report.
is 'each byte of a name that is not of UTF-8 has a mark' python3 - "$drape" <<'EOF'
import json, os, random, subprocess, sys
chance = random.Random(1)
bytes_ = [0x41, 0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xc1, 0xc2, 0xdf,
          0xe0, 0xe1, 0xec, 0xed, 0xee, 0xef, 0xf0, 0xf1, 0xf3, 0xf4, 0xf5, 0xff]

def read(name):
    text = ""
    while name:
        for k in range(1, 5):
            try:
                text, name = text + name[:k].decode(), name[k:]
                break
            except UnicodeDecodeError:
                pass
        else:
            text, name = text + "\ufffd", name[1:]
    return text

# each kind of first byte before each kind of second, and bytes of chance
names = [b"A".join(bytes([a, b, 0x80, 0x80]) for b in bytes_[1:10]) for a in bytes_]
names += [bytes(chance.choice(bytes_) for _ in range(60)) for _ in range(20)]
names += [b'"\\\n\x01\x7f\xc3\xa9\xf0\x9f\xa7\xb5\xe2\x82']
os.mkdir("names")
for name in names:
    file = b"names/" + name + b".json"
    with open(file, "w") as scene:
        scene.write('{"frames": 0, "cloths": [{"particles": [2, 2]}]}')
    subprocess.run([sys.argv[1], "run", file, "--out", "named.out", "--force",
                    "--quiet"], check=True)
    report = json.load(open("named.out/report.json", encoding="utf-8"))
    assert report["scene"] == read(name), (name, report["scene"])
    assert report["file"] == read(file), (name, report["file"])
EOF
printf '{"name": "a\\u0001\177\303\251", "frames": 0, "cloths": [{"particles": [3, 3],
  "size": [1, 1], "name": "q\\"\\\\\\n\360\237\247\265"}]}' >odd.json
exits 'names of odd characters' 0 run odd.json --out odd
is 'are in a report' python3 -c '
import json
r = json.loads(open("odd/report.json", "rb").read().decode("utf-8"))
assert r["scene"] == "a\1\x7f\xe9"
assert r["bodies"][0]["name"] == "q\"\\\n\U0001f9f5"'
printf '{"frames": 0,\n "name": "\377"}' >bytes.json
refused 'a scene that is no UTF-8' 'bytes.json: line 2, column 10: unable to decode' \
    plan bytes.json
