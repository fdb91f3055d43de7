# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# An audit of a run tests all bodies, or names those it could not test.
# Read by tests/app.sh, whose functions it calls.

exits 'a run with a moving obstacle' 0 run moves.json --out missing --frames 3
exits 'audit of all of it' 0 audit missing
rm missing/frames/obstacles_0002.ply
refused 'audit without a frame of the obstacles' \
    'in frame 2 cloth was not tested against the obstacles (ball, floor)' \
    audit missing
rm missing/report.json
refused 'audit without that frame and a report' 'obstacles_0002.ply' \
    audit missing
rm missing/frames/obstacles_*
refused 'audit of nobody knows what' 'cannot be tested' audit missing
cp -R u2 lost
rm lost/obstacles.ply
refused 'audit without still obstacles' \
    'in frame 0 cloth was not tested against the obstacles (ball)' audit lost
cp missing/frames/cloth_0000.ply lost/obstacles.ply
refused 'audit with obstacles of another run' 'lost/obstacles.ply: has 198' \
    audit lost
cp u2/obstacles.ply lost
cp missing/frames/cloth_0000.ply lost/frames/cloth_0003.ply
refused 'audit with a frame of another run' 'lost/frames/cloth_0003.ply' \
    audit lost
exits 'a run that has no obstacle' 0 run odd.json --out alone
exits 'audit of cloth alone' 0 audit alone
mkdir -p hundred/frames
cp u2/obstacles.ply u2/report.json hundred
frame=0
while [ $frame -lt 100 ]; do
    ln u2/frames/cloth_0000.ply "hundred/frames/cloth_$(printf %04d $frame).ply"
    frame=$((frame + 1))
done
exits 'audit of a hundred frames' 0 audit hundred
is 'audit counts them' grep -q '100 frames, 0 of them' out
