# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# A run, its files and its checkpoints.
# Read by tests/app.sh, whose functions it calls.

# A run and its files
mkdir 'a path'
cp tiny.json 'a path/my scene.json'
exits 'path with spaces' 0 run 'a path/my scene.json' --out 'an out' --obj
for name in frames/cloth_0006.ply frames/cloth_0006.obj obstacles.ply \
    obstacles.obj cloth.pc2 report.json; do
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
from geometry import load
d = open("an out/cloth.pc2", "rb").read()
assert struct.unpack("<12siiffi", d[:32]) == (
    b"POINTCACHE2\0", 1, 81, 0.0, 1.0, 7)
assert len(d) == 32 + 7 * 81 * 12
x, _ = load("an out/frames/cloth_0006.ply", "f")
assert d[-81 * 12:] == b"".join(struct.pack("<3f", *p) for p in x)'
# Contacts: a file of points a frame, and what each body got in each step.
exits 'run --contacts' 0 run tiny.json --frames 12 --out touch --contacts
is 'a file a frame' test "$(find touch/frames -name 'contacts_*.ply' | wc -l)" -eq 13
is 'the same frames without' sh -c '"$0" run tiny.json --frames 12 --out plain \
    --quiet && cmp touch/frames/cloth_0012.ply plain/frames/cloth_0012.ply' "$drape"
is 'the sums of its points are those of the report' \
    python3 "$root/tests/app/contacts.py" touch 12
exits 'a long run' 0 run tiny.json --frames 150 --every 150 --out touches --contacts \
    --quiet --checkpoint-every 100
cp touches/report.json touches.json
exits 'its end alone' 0 run tiny.json --frames 150 --every 150 --out touches --contacts \
    --quiet --resume touches/checkpoint.drape
is 'has the same impulses in each step' python3 -c '
import json
short, long, end = (json.load(open(name))["steps"] for name in (
    "touch/report.json", "touches.json", "touches/report.json"))
told = [step["impulses"] for step in long]
assert len(told) == 150 and all(len(i["bodies"]) == 2 for i in told)
assert told[:12] == [step["impulses"] for step in short]
assert told[100:] == [step["impulses"] for step in end[100:]]'
exits 'a part of it' 0 run tiny.json --frames 6 --out part --contacts \
    --checkpoint-every 6
exits 'the rest of it' 0 run tiny.json --frames 12 --out part --contacts \
    --resume part/checkpoint.drape
is 'is the same' sh -c 'for k in 0006 0012; do
    cmp touch/frames/contacts_$k.ply part/frames/contacts_$k.ply || exit 1; done'
is 'and its report has what came after the checkpoint' python3 -c '
import json
a, b = (json.load(open(d + "/report.json"))["steps"] for d in ("touch", "part"))
assert all("impulses" not in step for step in b[:6])
assert [s["impulses"] for s in b[6:]] == [s["impulses"] for s in a[6:]]'
exits 'without contacts, over it' 0 run tiny.json --frames 6 --out touch --force
is 'no contacts are left' test -z "$(find touch/frames -name 'contacts_*')"
sed 's/"frames"/"integrator": "verlet", "dt": 1e-4, "frames"/' tiny.json >verlet.json
refused 'contacts of an explicit integrator' 'explicit integrator keeps no list' \
    run verlet.json --out refused --contacts
# A sheet with a hole of 2 × 2 cells, whose middle particle has no triangle.
cat >hole.json <<EOF
{"frames": 1,
 "cloths": [{"name": "a sheet", "particles": [6, 5], "size": [0.5, 0.4],
   "start": {"at": [0, 2, 0]}, "cuts": [{"rect": [0.1, 0.1, 0.3, 0.3]}]},
  {"name": "b\u007fb", "particles": [3, 3], "start": {"at": [0, 3, 0]}}],
 "motions": [{"name": "up", "keys": [{"time": 1, "move": [0, 1, 0]}]}],
 "obstacles": [{"name": "ball", "shape": "sphere", "motion": "up"},
  {"name": "ground", "shape": "plane", "at": [0, -1, 0]}]}
EOF
for bits in 32 64; do
    exits "OBJ with names, UVs and a hole, $bits bits" 0 run hole.json --out hole \
        --obj --precision $bits --force
    is "the OBJ has what the PLY has but the particle of the hole, $bits bits" \
        python3 -c '
import struct, sys
from geometry import load
form = "f" if sys.argv[1] == "32" else "d"
x, _ = load("hole/frames/cloth_0001.ply", form)
del x[2 + 6 * 2]
rows = [line.split() for line in open("hole/frames/cloth_0001.obj")]
near = lambda a: struct.unpack(form, struct.pack(form, float(a)))[0]
assert [tuple(map(near, r[1:])) for r in rows if r[0] == "v"] == x
assert [r[1] for r in rows if r[0] == "o"] == ["a_sheet", "b_b"]
uv = [tuple(map(float, r[1:])) for r in rows if r[0] == "vt"]
assert len(uv) == 38 and uv[:6] == [(i / 5, 0) for i in range(6)]
assert uv[29:] == [(i / 2, j / 2) for j in range(3) for i in range(3)]
faces = [[tuple(map(int, c.split("/"))) for c in r[1:]] for r in rows
         if r[0] == "f"]
used = {v for face in faces for v, t in face if v == t}
assert used == set(range(1, 39)) and len(faces) == 2 * (20 - 4 + 4)
rows = [line.split() for line in open("hole/frames/obstacles_0001.obj")]
assert [r[1] for r in rows if r[0] == "o"] == ["ball", "ground"]' $bits
done
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
exits 'all frames over those' 0 run tiny.json --out second --frames 1 --force
is 'nothing of the run before is left' sh -c 'cd second/frames &&
    [ "$(echo *)" = "cloth_0000.ply cloth_0001.ply" ]'
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
    '! "$0" run tiny.json --out piped --force 2>&1 | grep -q "$(printf "\r")"' "$drape"
exits '--error' 0 run tiny.json --out near --frames 6 --error 0.004
is '--error chooses shorter steps and says its estimate' python3 -c '
import json
r = json.load(open("near/report.json"))
assert r["dt"] < 1 / 61 and 0 < r["error"]["estimated"] <= 0.004
assert abs(r["dt"] * r["steps_per_frame"] - 1 / 60) < 1e-12
assert len(r["steps"]) == 6 * r["steps_per_frame"]
assert abs(r["error"]["horizon"] - 0.1) < 1e-6
assert open("out").readline() == (
    "--error 0.004: %s, dt %.4g s, tolerance %g; estimated %.2g m rms for "
    "%.3g s, of time and solver\n" % (
        r["settings"]["integrator"], r["dt"], r["settings"]["tolerance"],
        r["error"]["estimated"], r["error"]["horizon"]))'
exits '--error of 5 cm' 0 run tiny.json --out coarse --frames 6 --error 0.05
is 'for which the cheapest setting suffices' python3 -c '
import json
r = json.load(open("coarse/report.json"))
assert r["steps_per_frame"] == 1 and 0 < r["error"]["estimated"] <= 0.05
assert r["settings"]["integrator"] == "baraff-witkin"'
is 'what it chooses and estimates is what other runs say' \
    python3 "$root/tests/app/errors.py" "$drape" $brief
exits '--error that no setting keeps' 1 run tiny.json --error 1e-9 --out refused
is 'what the finest has is said' grep -Eqx \
    'drape: --error 1e-09: not reached; the finest setting, dt 0.00013 s, has 0.000[0-9]+ m' err
refused '--error of no number' '--error' run tiny.json --error small
for e in 0 -1 nan 1001 1m; do
    refused "--error of $e" "--error $e: expected m above 0, to 1000" \
        run tiny.json --error $e
done
exits '--error of 1000' 0 run tiny.json --error 1000 --out coarsest --frames 1
refused '--error and --resume' '--error' \
    run tiny.json --error 1 --resume half/checkpoint.drape

# Checkpoints
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
refused 'resume from a part' 'drape: cut.drape: ' \
    run tiny.json --out refused --resume cut.drape
sed 's/\[9, 9\]/[8, 8]/' tiny.json >other.json
refused 'resume another scene' 'drape: half/checkpoint.drape: ' \
    run other.json --out refused --resume half/checkpoint.drape
scene long.json ', "steps_per_frame": 37, "sleep": false}'
# ended SIGNAL FOLDER: a run is sent the signal after its first frame.
ended() {
    "$drape" run long.json --out "$2" --frames 100000 >out 2>err &
    child=$!
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        sleep 0.25
        [ ! -s "$2/frames/cloth_0001.ply" ] || break
    done
    kill "-$1" $child
    wait $child
}
ended INT cut
is 'Ctrl-C exits 130' test $? -eq 130
ended TERM ended
is 'a run that is told to end exits 130' test $? -eq 130 -a -s ended/checkpoint.drape
is 'Ctrl-C leaves a checkpoint' test -s cut/checkpoint.drape
is 'and the report' grep -q '"end": "interrupted"' cut/report.json
frames=$(python3 -c '
import json
print(len(json.load(open("cut/report.json"))["steps"]) // 37 + 1)')
exits 'resume after Ctrl-C' 0 run long.json --out cut --frames "$frames" \
    --resume cut/checkpoint.drape
exits 'the same unbroken' 0 run long.json --out whole --frames "$frames"
is 'equal bit for bit' cmp cut/cloth.pc2 whole/cloth.pc2

# A cloth that no fabric would be
printf '{"frames": 60, "cloths": [{"particles": [11, 7], "size": [1, 0.5], "name": "rag",
 "pins": [{"edge": "u0"}, {"edge": "u1", "motion": "pull"}]}, {"particles": [5, 5],
 "start": {"at": [0, 9, 0]}}], "motions": [{"name": "pull", "keys": [{"time": 0},
 {"time": 0.8, "move": [19, 0, 0]}, {"time": 1, "move": [4, 0, 0]}]}]}\n' >pull.json
exits 'a sheet pulled to 20 times its length' 0 run pull.json --out pull
is 'which is said, with the frame' grep -qF \
    'note: cloth 0 (rag) is stretched to 20 times its length in frame 48, where' err
is 'and of no other cloth' test "$(grep -c stretched err)" -eq 1
exits 'to twice its length, nearly' 0 run pull.json --out pull --frames 2 --force
is 'of which nothing is said' sh -c '! grep -q stretched err'

# Options without effect
exits 'options without effect' 0 run tiny.json --out pull --force --frames 1 --block 64 \
    --checkpoint-every 9
is 'are said to have none' test "$(grep -c 'note: --.* has no effect' err)" -eq 2
is 'each with the reason' sh -c '
    grep -qx "drape: note: --block has no effect: backend ref computes" err &&
    grep -qx "drape: note: --checkpoint-every 9 has no effect: the run has 1 frames" err'
exits 'options with an effect' 0 run tiny.json --out pull --force --frames 1 --threads 1 \
    --checkpoint-every 1
is 'of which nothing is said' sh -c '! grep -q "no effect" err'
