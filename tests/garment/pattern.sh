# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# Sewing patterns: what is cut is what was drawn, and malformed ones are refused.
# Read by tests/app.sh, whose functions it calls.

is 'panels are cut as drawn' python3 "$root/tests/garment/pattern.py" "$drape"
is 'the T-shirt is cut as drawn' python3 "$root/tests/garment/pattern.py" "$drape" \
    "$root/app/patterns/tee.json"
set -- "${DRAPE_DATA:-$root/build/data}"/garments/*.json
if [ -e "$1" ]; then
    is 'garments are cut as drawn' python3 "$root/tests/garment/pattern.py" "$drape" "$@"
else
    skip 'garments of others: no garments in DRAPE_DATA'
fi

cp "$root/app/patterns/tee.json" tee.json
exits 'a pattern without --out' 0 pattern tee.json
is 'prints a row a panel and a seam' test "$(grep -c '^' out)" -eq 18
is 'and writes nothing' test ! -e panels.csv
exits 'a pattern with --out' 0 pattern tee.json --out tee --cell 0.01
is 'prints the same table' test "$(grep -c '^' out)" -eq 18
is 'the picture is XML' python3 -c '
import xml.etree.ElementTree as tree
texts = [e.text for e in tree.parse("tee/pattern.svg").iter() if e.text]
assert "left_sleeve" in texts and texts.count("4") == 2'
is 'the panels are meshes' sh -c '"$0" audit tee/*.ply >audit.out; test $? -le 1' "$drape"
exits 'a pattern to a folder that cannot be' 3 pattern tee.json --out tee.json/x

# Two squares with a corner cut by 6 mm, sewn there and beside it.
python3 - <<'EOT'
import json
import math
cut = 0.6 / math.sqrt(2)
ring = [[0, 0], [30, 0], [30, 30 - cut], [30 - cut, 30], [0, 30]]
edges = [{"endpoints": [k, (k + 1) % 5]} for k in range(5)]
panels = {"a": {"vertices": ring, "edges": edges},
          "b": {"vertices": [[60 - x, y] for x, y in ring], "edges": edges}}
stitches = [[{"panel": p, "edge": k} for p in "ab"] for k in (1, 2)]
json.dump({"pattern": {"panels": panels, "stitches": stitches},
           "properties": {"units_in_meter": 100}}, open("cut.json", "w"))
EOT
exits 'a stitch shorter than a cell' 0 pattern cut.json --out cut --cell 0.01
is 'is closed up' grep -q 'stitch 1, of edge 2 of panel a, 6 mm long' err
is 'and the outline goes through its middle' python3 -c '
from geometry import load
corner = max(load("cut/00_a.ply")[0], key=lambda p: p[0] + p[1])
assert all(abs(x - 0.3 + 0.003 / 2**0.5) < 1e-6 for x in corner[:2]), corner'
exits 'by cells that are shorter' 0 pattern cut.json --cell 0.005
is 'it is a seam' test "$(grep -c 'closed up' err)" -eq 0

# panel PYTHON: a scene of the front panel, after a change of it, to panel.json.
panel() {
    python3 - "$1" >panel.json <<'EOT'
import json
import sys
cloth = {"panel": {"pattern": "tee.json", "name": "front", "cell": 0.02}}
scene = {"frames": 3, "cloths": [cloth]}
panel = cloth["panel"]
exec(sys.argv[1])
json.dump(scene, sys.stdout)
EOT
}
panel 'cloth["pins"] = [{"outline": 3}, {"at": [0.26, 0]}]'
exits 'a scene with a panel runs' 0 run panel.json --out hung
is 'and is clean' test "$("$drape" audit hung 2>&1 | grep -c ' 0 pairs')" -eq 1
is 'it starts where the pattern places it' python3 -c '
from geometry import load
z = [p[2] for p in load("hung/frames/cloth_0000.ply")[0]]
assert all(abs(each - 0.18) < 1e-6 for each in z), (min(z), max(z))'
panel 'cloth["start"] = {"at": [0, 1, 0]}'
exits 'a panel starts flat where told' 0 run panel.json --out flat_panel
panel 'panel["name"] = "sleeve"'
refused 'a panel that is not there' 'has no panel sleeve' run panel.json
panel 'del panel["name"]'
refused 'a panel without a name' 'has 4 panels' run panel.json
panel 'panel["pattern"] = "none.json"'
refused 'a panel of no file' 'pattern none.json: no such file' run panel.json
panel 'cloth["size"] = [1, 1]'
refused 'a panel with a size' 'size: not beside panel' run panel.json
panel 'cloth["pins"] = [{"outline": 8}]'
refused 'a pin on no edge' 'outline: 8: expected an edge of the panel' run panel.json
panel 'cloth["pins"] = [{"edge": "v0"}]'
refused 'a pin on an edge of the grid' 'a panel has edges of its outline' run panel.json
panel 'cloth["start"] = {"shape": "hung"}'
refused 'a hung panel' 'start: a panel starts flat' run panel.json
panel 'scene["integrator"] = "verlet"'
refused 'a panel with Verlet' 'a panel needs an implicit integrator' run panel.json

# change PYTHON: prints the T-shirt after this change.
change() {
    python3 - "$1" <<'EOT'
import json
import sys
tee = json.load(open("tee.json"))
pattern = tee["pattern"]
panels, stitches = pattern["panels"], pattern["stitches"]
front = panels["front"]
vertices, edges = front["vertices"], front["edges"]
exec(sys.argv[1])
json.dump(tee, sys.stdout)
EOT
}
# broken NAME TEXT PYTHON: the T-shirt is refused after this change, by this text.
broken() {
    change "$3" >bad.json
    refused "pattern: $1" "bad.json: $2" pattern bad.json --out refused
}
front='$.pattern.panels.front'
broken 'an open outline' \
    "$front: the outline is open: edge 0 ends in vertex 0, where no other edge does" \
    'edges.pop()'
broken 'an outline that branches' "$front: 4 edges meet in vertex 0, edges 0 and 7" \
    'edges.append({"endpoints": [0, 4]}); edges.append({"endpoints": [4, 0]})'
broken 'a hole' "$front: edge 8 is not of the outline that edge 0 is of" '
vertices += [[0, 30], [2, 30], [0, 32]]
edges += [{"endpoints": [8 + k, 8 + (k + 1) % 3]} for k in range(3)]'
broken 'edges that cross' 'panel front: edges 1 and 7 cross or touch near' \
    'vertices[0], vertices[1] = vertices[1], vertices[0]'
broken 'an edge that crosses itself' \
    'panel front: edge 3 crosses or touches itself near' \
    'edges[3]["curvature"] = {"type": "cubic", "params": [[3, -1.5], [-2, -1.5]]}'
broken 'an outline that turns back' 'panel front: edges 0 and 1 cross or touch' \
    'vertices[2] = [0, 0]; edges[2].pop("curvature")'
broken 'an edge of no length' \
    "$front.edges[1].endpoints: the edge has no length: both ends are at (26, 0)" \
    'vertices[2] = vertices[1]'
broken 'an edge from a vertex to itself' "$front.edges[1].endpoints: the edge has no" \
    'edges[1]["endpoints"] = [1, 1]'
broken 'a vertex that is not there' \
    "$front.edges[1].endpoints[1]: 8: expected a whole number from 0 to 7" \
    'edges[1]["endpoints"] = [1, 8]'
broken 'an outline of no area' "$front: the outline encloses 0 m²" '
front["vertices"] = [[0, 0], [10, 0]]
front["edges"] = [{"endpoints": [0, 1]}, {"endpoints": [1, 0]}]'
broken 'one edge' "$front.edges: expected at least 2 edges" 'del edges[1:]'
broken 'no edges' "$front: has no \"edges\"" 'del front["edges"]'
broken 'edges that are null' "$front: has no \"edges\"" 'front["edges"] = None'
broken 'no endpoints' "$front.edges[2]: has no \"endpoints\"" 'del edges[2]["endpoints"]'
broken 'no panels' "\$.pattern: has no \"panels\"" 'del pattern["panels"]'
broken 'no panel' "\$.pattern.panels: expected an object of 1 to 1000 panels" \
    'panels.clear()'
broken 'no pattern' "\$: has no \"pattern\"" 'del tee["pattern"]'
broken 'a list' "\$: expected an object" 'tee = []'
broken 'a vertex of one number' "$front.vertices[3]: expected a list of 2 numbers" \
    'vertices[3] = [1]'
broken 'a vertex of text' "$front.vertices[3][1]: expected a number" \
    'vertices[3] = [1, "2"]'
broken 'a vertex far away' "$front.vertices[3][1]: 1e+300: expected a number" \
    'vertices[3] = [1, 1e300]'
broken 'not a number' 'line 1, column' 'vertices[3] = [1, float("nan")]'
broken 'an infinite number' 'line 1, column' 'vertices[3] = [1, float("inf")]'
broken 'an unknown curve' \
    "$front.edges[2].curvature.type: \"quadratics\": did you mean \"quadratic\"?" \
    'edges[2]["curvature"]["type"] = "quadratics"'
broken 'a curve of too few points' \
    "$front.edges[2].curvature.params: expected a list of 2 control points" \
    'edges[2]["curvature"]["type"] = "cubic"'
broken 'a curve without points' "$front.edges[2].curvature: has no \"params\"" \
    'del edges[2]["curvature"]["params"]'
broken 'a polyline without points' \
    "$front.edges[1].curvature.params: expected a list of 1 to 10000 points" \
    'edges[1]["curvature"] = {"type": "polyline", "params": []}'
broken 'a polyline with a side of no length' \
    "$front.edges[1].curvature.params: corners 1 and 2 are one place, (26, 12.6)" \
    'edges[1]["curvature"] = {"type": "polyline", "params": [[0.3, 0], [0.3, 0]]}'
broken 'a circle without flags' \
    "$front.edges[4].curvature.params: expected a radius and two flags" \
    'edges[4]["curvature"]["params"] = [9]'
broken 'a circle that is too small' \
    "$front.edges[4].curvature.params: a circle of radius 7.9 has no chord of 16" \
    'edges[4]["curvature"]["params"][0] = 7.9'
broken 'a seam to an edge that is not there' \
    "\$.pattern.stitches[2][1].edge: 8: panel back has edges 0 to 7" \
    'stitches[2][1]["edge"] = 8'
broken 'a seam to a panel that is not there' \
    "\$.pattern.stitches[2][1].panel: there is no panel \"bak\"; did you mean \"back\"?" \
    'stitches[2][1]["panel"] = "bak"'
broken 'an edge in two seams' \
    "\$.pattern.stitches[3][0]: edge 3 of panel front is a side of stitch 2 already" \
    'stitches[3][0]["edge"] = 3'
broken 'a seam of one side' "\$.pattern.stitches[3]: expected a list of two sides" \
    'stitches[3].pop()'
broken 'a side without an edge' "\$.pattern.stitches[3][0]: has no \"edge\"" \
    'del stitches[3][0]["edge"]'
broken 'a seam of another kind' "\$.pattern.stitches[3][2]: expected \"right_wrong\"" \
    'stitches[3].append("left_wrong")'
broken 'an order of others' "\$.pattern.panel_order[0]: \"hood\" is no panel" \
    'pattern["panel_order"] = ["hood"]'
broken 'an order of one twice' "\$.pattern.panel_order[1]: \"back\" is no panel, or" \
    'pattern["panel_order"] = ["back", "back"]'
for unit in 0 -100 '"cm"' '[100]'; do
    broken "a unit of $unit" "\$.properties.units_in_meter: " \
        "tee['properties']['units_in_meter'] = $unit"
done
broken 'a unit that is too large' "$front: is 67 m large, expected 0.005 to 20 m; is $(
    )units_in_meter 1 right?" "tee['properties']['units_in_meter'] = 1"
broken 'a unit that is too small' "$front: is 0.000134 m large" \
    "tee['properties']['units_in_meter'] = 5e5"
broken 'other coordinates' "\$.properties.curvature_coords: \"polar\": expected one of" \
    "tee['properties']['curvature_coords'] = 'polar'"
# A strap of a tenth of a centimetre in the neck, and a gap as narrow.
# narrow Y BOTTOM: two lines 1 mm apart in the neck, from Y to BOTTOM.
narrow() {
    cat <<EOT
vertices[4:6] = [[8, $1], [0.05, $1], [0.05, $2], [-0.05, $2], [-0.05, $1], [-8, $1]]
n = len(vertices)
front["edges"] = [{"endpoints": [k, (k + 1) % n]} for k in range(n)]
pattern["stitches"] = [s for s in stitches if s[0]["panel"] != "front"]
EOT
}
broken 'a strap below a cell' \
    'panel front: the strap between edges 5 and 7 is 1 mm wide, which is less than' \
    "$(narrow 67 87)"
change "$(narrow 67 47)
del tee['properties']['units_in_meter']" >slit.json
exits 'a gap below a cell' 0 pattern slit.json
is 'is told of' grep -q 'the gap between edges 5 and 7 is 0.2 cells wide' err
is 'and so is a unit that is not there' grep -q 'has no units_in_meter' err
exits 'a gap of cells' 0 pattern slit.json --cell 0.001
is 'is cut' sh -c '! grep -q gap err'
sed 's/"back": {/"front": {/' tee.json >bad.json
refused 'two panels of one name' 'column 10: duplicate object key near' pattern bad.json
printf '{"pattern": ' >bad.json
refused 'a pattern that ends early' 'bad.json: line 1' pattern bad.json
refused 'no pattern file' 'none.json: No such file' pattern none.json
refused 'two patterns' 'expected one FILE' pattern tee.json tee.json
for cell in 0 -1 0.2 1e-5 nan 5mm; do
    refused "cells of $cell" "--cell $cell: expected metres from 0.0001 to 0.1" \
        pattern tee.json --cell $cell --out refused
done
# An edge shorter than a cell has no length in cells, and its seam goes with it.
change '
vertices.append([26, 0.1])
edges[1]["endpoints"] = [8, 2]
edges.append({"endpoints": [1, 8]})
stitches.append([{"panel": "front", "edge": 8}, {"panel": "back", "edge": 0}])' >short.json
exits 'an edge shorter than a cell' 0 pattern short.json
is 'is told of, and its seam' grep -q "panel front: edge 8, 1 mm long, is too short $(
    )for cells, and with it goes stitch 10" err
exits 'but notes can be left out' 0 pattern short.json --quiet
is 'none is there' test ! -s err
# The tip of a lapel, exactly a cell from a particle of the grid, which stays away.
python3 - >lapel.json <<'EOT'
import json
import sys
curve = {"type": "quadratic", "params": [[0.3, -0.2]]}
panel = {"vertices": [[0, 0], [7, -20.3], [7, 0]], "edges": [
    {"endpoints": [0, 1], "curvature": curve}, {"endpoints": [1, 2]}, {"endpoints": [2, 0]}]}
json.dump({"pattern": {"panels": {"lapel": panel}},
           "properties": {"units_in_meter": 100, "curvature_coords": "relative"}},
          sys.stdout)
EOT
echo '{"frames": 0, "cloths": [{"panel": {"pattern": "lapel.json", "cell": 0.01}}]}' >one.json
exits 'a tip a whole cell from its particle' 0 run one.json --out lapel
