# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Meshes are read as their formats say.
# Read by tests/app.sh, whose functions it calls.

is 'PLY of every form and type' python3 "$root/tests/app/ply.py" "$drape"
ply bad.ply '3 0 1 2' 'element vertex 3' \
    'element vertex 0\nproperty float x\nproperty float y\nproperty float z\n&'
no_mesh 'PLY with vertices twice' 'expected one element vertex, found 2' bad.ply
# A header of many properties, and a line that is longer than any.
props() {
    ply props.ply '3 0 1 2' 'double z' "double z\\n$(awk -v n="$1" 'BEGIN {
        for (k = 0; k < n; k++) printf "property double a%d\\n", k }')comment $(
            printf '%0300d' 0)"
    awk -v n="$1" '/^[01] [01] 0$/ { for (k = 0; k < n; k++) $0 = $0 " 7" } 1' \
        props.ply >props_of.ply
}
props 61
exits 'PLY, vertices of 64 properties' 0 convert props_of.ply many.ply
props 62
no_mesh 'PLY, vertices of 65 properties' 'line 68: not a PLY' props_of.ply

# OFF: what may stand before it, comments, white space, and a pentagon
for head in OFF COFF NOFF CNOFF STOFF STCNOFF; do
    printf '# a mesh\n\n %s # its head\r\n\t5 1 0\n' "$head" >five.off
    printf '%s\n' '0 0 0 9 9' '	1	0 0 # second' '2 1 0' '1 2 0' '0 1 0' \
        '5 0 1 2 3 4  0.5 # a colour' '# end' >>five.off
    exits "$head" 0 convert five.off five_off.ply
    is "$head: a fan of three triangles" cmp five_off.ply five_3.ply
done
for head in XOFF SOFF NCOFF OF 'OFF 5' 'OFF -1 1' 'OFF 5 x'; do
    { echo "$head" && tail -n +5 five.off; } >bad.off
    no_mesh "$head" 'line 1: expected' bad.off
done
off bad.off 'OFF 4 1 0' 'x 0 1 2'
no_mesh 'OFF, a face of no number' "line 8: expected a face's number" bad.off
off bad.off 'OFF 4 2 0' '2 0 1' '0'
no_mesh 'OFF, faces without a triangle' 'no triangles' bad.off
for x in '0 1' '0 1 x' '0 1 nan' '0 1 1152921504606847232' '0 1 1x'; do
    off bad.off 'OFF 4 1 0' '3 0 1 2'
    sed -i "s/^0 1 0$/$x/" bad.off
    no_mesh "OFF, vertex $x" 'line 6: expected three coordinates' bad.off
done
printf 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1152921504606846976 0\n3 0 1 2\n' >far.off
exits 'OFF, a coordinate of 2^60' 0 convert far.off far.ply
printf 'v 0 0 0\nv 1 0 0\nv 0 2e18 0\nf 1 2 3\n' >far.obj
no_mesh 'OBJ, a coordinate beyond 2^60' \
    'vertex 2: a coordinate is not finite or beyond 2^60' far.obj
mkdir folder.ply
no_mesh 'a folder as a mesh' 'no such mesh file' folder.ply

# A node of glTF is placed in its parent, and a mesh in its node.
gltf good.gltf AAEC 3
python3 - <<'EOT'
import json
scene = json.load(open("good.gltf"))
scene["nodes"] = [
    {"children": [1, 2], "translation": [3, 0, -2], "scale": [1, 2, 3]},
    {"mesh": 0, "rotation": [0, 0, 0.6, 0.8]},
    {"mesh": 0, "matrix": [0, 2, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 5, 6, 7, 1]}]
json.dump(scene, open("placed.gltf", "w"))
EOT
with '"obstacles": [{"mesh": "placed.gltf"}], "precision": 64, "allow_intersecting": true'
exits 'glTF with placed nodes' 0 run scene.json --out placed --quiet
is 'the places are products of matrices' python3 -c '
from geometry import load
x, _ = load("placed/obstacles.ply", "d")
# 0.28 and 0.96: cosine and sine of twice the angle that has 0.8 and 0.6
one = [[0, 0, 0], [0.28, 0.96, 0], [-0.96, 0.28, 0]]
two = [[5, 6, 7], [5, 8, 7], [5, 6, 8]]
for a, b in zip(x, one + two):
    b = [3 + b[0], 2 * b[1], 3 * b[2] - 2]
    assert max(abs(p - q) for p, q in zip(a, b)) < 1e-6, (a, b)'

# assimp passes on a face that names a vertex which is not there, and a line: by a
# library that makes them of the first two of a quad's triangles.
cat >beyond.c <<'EOF'
#define _GNU_SOURCE
#include <assimp/cimport.h>
#include <assimp/scene.h>
#include <dlfcn.h>
#include <stdlib.h>
const struct aiScene *aiImportFile(const char *path, unsigned flags)
{
    typedef const struct aiScene *call(const char *, unsigned);
    const struct aiScene *scene = ((call *)dlsym(RTLD_NEXT, "aiImportFile"))(path, flags);
    struct aiMesh *mesh = scene->mMeshes[0];
    if (getenv("LINE"))
        mesh->mFaces[0].mNumIndices = 2;
    else
        mesh->mFaces[1].mIndices[2] = mesh->mNumVertices;
    return scene;
}
EOF
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n' >quad.obj
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC beyond.c -o beyond.so -ldl 2>/dev/null; then
    skip 'faces beyond all vertices: no library can stand before this tool'
else
    env LD_PRELOAD="$PWD/beyond.so" "$drape" convert quad.obj beyond.ply >out 2>err
    is 'a face beyond all vertices' test $? -eq 2 -a ! -e beyond.ply
    is 'is said to be one' grep -qx "drape: quad.obj: cannot be read as a mesh: $(
        )a face names a vertex that is not there" err
    is 'a line among faces' env LINE=1 LD_PRELOAD="$PWD/beyond.so" "$drape" convert \
        quad.obj line.ply
    is 'is left out' grep -aq '^element face 1$' line.ply
fi

# What is written is what was read, to the last bit.
exits 'a mesh of thirds' 0 run patch.json --out thirds --quiet --frames 0
"$drape" convert thirds/frames/cloth_0000.ply third.ply --size 0.3333 --quiet
exits 'as OBJ' 0 convert third.ply third.obj
exits 'as PLY' 0 convert third.ply again.ply
is 'OBJ has enough digits' python3 -c '
import struct
from geometry import load
x, _ = load("again.ply", "f")
f32 = lambda a: struct.unpack("f", struct.pack("f", float(a)))[0]
rows = [line.split()[1:] for line in open("third.obj") if line[0] == "v"]
assert len(rows) == 99 and [tuple(map(f32, r)) for r in rows] == x'
