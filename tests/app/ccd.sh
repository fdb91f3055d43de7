# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Collision queries: what rows may be, what the truth is, and all pairs of a mesh.
# Read by tests/app.sh, whose functions it calls.

is 'the pairs of a mesh are those that touch alone' \
    python3 "$root/tests/app/touches.py" "$drape"
refused 'ccd of a kind that is none' 'expected --kind vf or' ccd --kind fv hit.csv
refused 'ccd of two files' 'expected one FILE.csv' ccd --kind vf hit.csv hit.csv
refused 'ccd of frames and a kind' 'expected two meshes' \
    ccd --frames --kind vf before.ply after.ply
refused 'ccd of three frames' 'expected two meshes' \
    ccd --frames before.ply after.ply after.ply
# row NAME NUMBER TEXT EXPECTED: hit.csv with this text in this row
row() {
    sed "$2s/.*/$3/" hit.csv >row.csv
    refused "ccd, $1" "row.csv: line $2: expected $4" ccd --kind vf row.csv
}
row 'a truth at last' 5 0,1,0,1,0,1,1 'as many columns as in the rows before'
row 'eight columns' 3 0,1,0,1,0,1,1,2 '6 or 7 columns'
row 'nine columns' 3 0,1,0,1,0,1,1,2,3 '6 or 7 columns'
row 'a number of no digit' 3 0,1,0,1,,1 'whole numbers'
row 'a sign alone' 3 0,1,0,1,-,1 'whole numbers'
row 'a space' 3 '0,1,0,1, 1,1' 'whole numbers'
row 'a letter' 3 0,1,0,1,0,1x 'whole numbers'
printf '0,1,0,1,0,1\000\n' >zero.csv
refused 'ccd, a zero byte' 'zero.csv: line 1: expected text' ccd --kind vf zero.csv
sed '3s/.$/2/' truth.csv >row.csv
refused 'ccd, a truth of 2' 'row.csv: line 3: expected truth 0 or 1' \
    ccd --kind vf row.csv
sed '3s/.$/0/' truth.csv >row.csv
refused 'ccd, two truths' 'row.csv: line 3: expected the same truth in all 8' \
    ccd --kind vf row.csv
# The vertex stays above its face: nothing touches, whatever the truth says.
sed '5s/.*/1,4,1,4,1,1/' hit.csv >above.csv
cat truth.csv lie.csv >both.csv
for truth in 0 1; do
    sed "s/\$/,$truth/" above.csv | tee -a both.csv >above_$truth.csv
done
exits 'ccd of a pair apart' 0 ccd --kind vf above_0.csv
is 'which is said' test "$(cat out)" = 0
exits 'ccd that misses' 1 ccd --kind vf above_1.csv
is 'is counted' grep -qx '1 queries, 1 missed, 0 invented' err
exits 'ccd of all four' 1 ccd --kind vf both.csv
is 'counts both' grep -qx '4 queries, 1 missed, 1 invented' err
# As vertex and face and as two edges the same points are other pairs.
exits 'ccd of edges' 0 ccd --kind ee hit.csv
is 'that touch not, as another program says' test "$(cat out)" = "$(python3 - <<'EOT'
from fractions import Fraction as F
rows = [line.split(",") for line in open("hit.csv")]
x = [[F(int(r[k]), int(r[k + 1])) for k in (0, 2, 4)] for r in rows]
# only the first point moves, in z: where its edge is in the plane z = 0 of the
# other three, do the segments cross?
det = lambda a, b, c: (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
assert x[1:4] == x[5:] and all(p[2] == 0 for p in x[1:4]) and x[0][:2] == x[4][:2]
a, b, c, d = x[:4]
cross = det(a, b, c) * det(a, b, d) <= 0 and det(c, d, a) * det(c, d, b) <= 0
print("1 %.17g" % (a[2] / (a[2] - x[4][2])) if cross else "0")
EOT
)"
