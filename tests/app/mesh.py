# SPDX-License-Identifier: Apache-2.0
"""Meshes: whether two are the same; animated ones whose motion is known.

usage: mesh.py same A.ply B.ply         two binary PLY files of the tool hold the same
                                        triangles in the same order, corners in any
                                        cyclic order and within 1e-5 m; else it fails
                                        with a line that names the first other one
       mesh.py write                    nodes.gltf, bones.gltf, morph.gltf, two.gltf,
                                        slide.fbx, bones.fbx, cube.fbx
       mesh.py check KIND DIR           the frames of a run move as KIND does: nodes,
                                        lift, bones, morph, slide, still
"""
import base64
import json
import math
import struct
import sys

from geometry import load

# A triangle of three vertices, as far apart as they are easy to tell.
REST = [(0, 0, 0), (1, 0, 0), (0, 2, 0)]


class File:
    """A glTF file with its buffer inside."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def add(self, values, kind, component=5126):
        """An accessor of floats, of bytes (5121) or of short numbers (5123)."""
        code = {5126: "f", 5121: "B", 5123: "H"}[component]
        self.data += b"\0" * (-len(self.data) % 4)
        packed = b"".join(struct.pack(f"<{len(v)}{code}", *v) for v in values)
        self.views.append({"buffer": 0, "byteOffset": len(self.data),
                           "byteLength": len(packed)})
        self.data += packed
        accessor = {"bufferView": len(self.views) - 1, "componentType": component,
                    "count": len(values), "type": kind}
        if kind in ("VEC3", "SCALAR"):
            accessor["min"] = [min(v[k] for v in values) for k in range(len(values[0]))]
            accessor["max"] = [max(v[k] for v in values) for k in range(len(values[0]))]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, **more):
        return {"primitives": [{"attributes": {"POSITION": self.add(REST, "VEC3"),
                                               **more.pop("attributes", {})},
                                "indices": self.add([(0,), (1,), (2,)], "SCALAR", 5123),
                                **more}]}

    def save(self, name, **parts):
        text = base64.b64encode(self.data).decode()
        parts = {"asset": {"version": "2.0"}, "scene": 0, "accessors": self.accessors,
                 "bufferViews": self.views, "buffers": [{
                     "byteLength": len(self.data),
                     "uri": "data:application/octet-stream;base64," + text}], **parts}
        with open(name, "w") as file:
            json.dump(parts, file)


def channel(node, path, sampler):
    return {"sampler": sampler, "target": {"node": node, "path": path}}


def sampler(file, times, values, kind):
    return {"input": file.add([(t,) for t in times], "SCALAR"),
            "output": file.add(values, kind)}


def quarter(axis, turns):
    q = [0.0, 0.0, 0.0, math.cos(math.pi * turns)]
    q[axis] = math.sin(math.pi * turns)
    return tuple(q)


def write_nodes(name, clips):
    """A parent that turns a quarter about z in 1 s; its child goes 2 m along x and
    grows to twice the size. With two clips the second leaves all at rest but goes
    1 m along y."""
    file = File()
    mesh = file.mesh()
    first = {"name": "swing", "samplers": [
        sampler(file, (0, 1), [quarter(2, 0), quarter(2, 0.25)], "VEC4"),
        sampler(file, (0, 0.5, 1), [(0, 0, 0), (1, 0, 0), (2, 0, 0)], "VEC3"),
        sampler(file, (0, 1), [(1, 1, 1), (2, 2, 2)], "VEC3")],
        "channels": [channel(0, "rotation", 0), channel(1, "translation", 1),
                     channel(1, "scale", 2)]}
    second = {"name": "lift", "samplers": [
        sampler(file, (0, 1), [(0, 0, 0), (0, 1, 0)], "VEC3")],
        "channels": [channel(1, "translation", 0)]}
    file.save(name, scenes=[{"nodes": [0]}], meshes=[mesh],
              nodes=[{"name": "arm", "children": [1]}, {"name": "hand", "mesh": 0}],
              animations=[first, second][:clips])


def write_bones():
    """Two bones at x = 0 and x = 1; the second goes 3 m along z in 1 s. Vertex 0
    hangs on the first, vertex 1 on the second, vertex 2 on both alike."""
    file = File()
    joints = file.add([(0, 0, 0, 0), (1, 0, 0, 0), (0, 1, 0, 0)], "VEC4", 5121)
    weights = file.add([(1, 0, 0, 0), (1, 0, 0, 0), (0.5, 0.5, 0, 0)], "VEC4")
    one = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    back = one[:12] + [-1, 0, 0, 1]
    file.save("bones.gltf", scenes=[{"nodes": [0, 1]}],
              meshes=[file.mesh(attributes={"JOINTS_0": joints, "WEIGHTS_0": weights})],
              skins=[{"joints": [1, 2], "inverseBindMatrices":
                      file.add([tuple(one), tuple(back)], "MAT4")}],
              nodes=[{"name": "body", "mesh": 0, "skin": 0},
                     {"name": "hip", "children": [2]},
                     {"name": "knee", "translation": [1, 0, 0]}],
              animations=[{"name": "kick", "samplers": [
                  sampler(file, (0, 1), [(1, 0, 0), (1, 0, 3)], "VEC3")],
                  "channels": [channel(2, "translation", 0)]}])


def write_morph():
    """One target, which takes vertex 1 by 4 m along y, from weight 0 to 1 in 1 s."""
    file = File()
    target = {"POSITION": file.add([(0, 0, 0), (0, 4, 0), (0, 0, 0)], "VEC3")}
    file.save("morph.gltf", scenes=[{"nodes": [0]}],
              meshes=[{**file.mesh(targets=[target]), "weights": [0]}],
              nodes=[{"name": "sail", "mesh": 0}],
              animations=[{"name": "blow", "samplers": [
                  sampler(file, (0, 1), [(0,), (1,)], "SCALAR")],
                  "channels": [channel(0, "weights", 0)]}])


SECOND = 46186158000  # in FBX's units of time


def write_fbx(name, bones):
    """The triangle in centimetres; its node, or the second of its two bones, goes 3 m
    along z in 1 s. The bones are as in write_bones."""
    first = 100 if bones else 0
    moved = 2002 if bones else 2000
    points = ",".join(str(100 * c) for v in REST for c in v)
    models = """
	Model: 2001, "Model::hip", "LimbNode" {
	}
	Model: 2002, "Model::knee", "LimbNode" {
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",100,0,0
		}
	}
	Deformer: 4000, "Deformer::", "Skin" {
	}""" if bones else ""
    links = """
	C: "OO",2001,0
	C: "OO",2002,2001
	C: "OO",4000,1000""" if bones else ""
    for k, (vertices, weights) in enumerate([((0, 2), (1, .5)), ((1, 2), (1, .5))]):
        if not bones:
            break
        at = f"1,0,0,0,0,1,0,0,0,0,1,0,{100 * k},0,0,1"
        back = f"1,0,0,0,0,1,0,0,0,0,1,0,{-100 * k},0,0,1"
        models += f"""
	Deformer: {4001 + k}, "SubDeformer::", "Cluster" {{
		Indexes: *2 {{
			a: {vertices[0]},{vertices[1]}
		}}
		Weights: *2 {{
			a: {weights[0]},{weights[1]}
		}}
		Transform: *16 {{
			a: {back}
		}}
		TransformLink: *16 {{
			a: {at}
		}}
	}}"""
        links += f"""
	C: "OO",{4001 + k},4000
	C: "OO",{2001 + k},{4001 + k}"""
    curves = "".join(f"""
	AnimationCurve: {3003 + k}, "AnimCurve::", "" {{
		KeyTime: *2 {{
			a: 0,{SECOND}
		}}
		KeyValueFloat: *2 {{
			a: {a},{b}
		}}
	}}""" for k, (a, b) in enumerate([(first, first), (0, 0), (0, 300)]))
    curve_links = "".join(f"""
	C: "OP",{3003 + k},3002, "d|{axis}\"""" for k, axis in enumerate("XYZ"))
    with open(name, "w") as file:
        file.write(f"""; FBX 7.4.0 project file
FBXHeaderExtension:  {{
	FBXHeaderVersion: 1003
	FBXVersion: 7400
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UnitScaleFactor", "double", "Number", "",1
	}}
}}
Objects:  {{
	Geometry: 1000, "Geometry::tri", "Mesh" {{
		Vertices: *9 {{
			a: {points}
		}}
		PolygonVertexIndex: *3 {{
			a: 0,1,-3
		}}
		GeometryVersion: 124
	}}
	Model: 2000, "Model::tri", "Mesh" {{
		Version: 232
	}}{models}
	AnimationStack: 3000, "AnimStack::Take", "" {{
		Properties70:  {{
			P: "LocalStop", "KTime", "Time", "",{SECOND}
		}}
	}}
	AnimationLayer: 3001, "AnimLayer::Base", "" {{
	}}
	AnimationCurveNode: 3002, "AnimCurveNode::T", "" {{
	}}{curves}
}}
Connections:  {{
	C: "OO",2000,0
	C: "OO",1000,2000{links}
	C: "OO",3001,3000
	C: "OO",3002,3001
	C: "OP",3002,{moved}, "Lcl Translation"{curve_links}
}}
""")


def write_cube():
    """A cube of 1 m that stands still, in centimetres."""
    v = [(x, y, z) for x in (0, 100) for y in (0, 100) for z in (0, 100)]
    q = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
         (1, 5, 7, 3)]
    points = ",".join(str(c) for p in v for c in p)
    faces = ",".join(str(i if k < 3 else -i - 1) for f in q for k, i in enumerate(f))
    with open("slide.fbx") as file:
        text = file.read()
    text = text[:text.index("\tAnimationStack")] + text[text.index("}\nConnections"):]
    for old, new in [('C: "OO",3001,3000', ""), ('C: "OO",3002,3001', ""),
                     ("*9", "*24"), ("*3 {", "*24 {"), ("a: 0,1,-3", f"a: {faces}"),
                     (text.split("a: ")[1].split("\n")[0], points)]:
        text = text.replace(old, new, 1)
    text = "".join(line for line in text.splitlines(True) if '"OP"' not in line)
    with open("cube.fbx", "w") as file:
        file.write(text)


def expected(kind, s):
    s = min(s, 1)
    if kind == "nodes":
        c, n = math.cos(math.pi / 2 * s), math.sin(math.pi / 2 * s)
        grown = [((1 + s) * x + 2 * s, (1 + s) * y, (1 + s) * z) for x, y, z in REST]
        return [(c * x - n * y, n * x + c * y, z) for x, y, z in grown]
    if kind == "lift":
        return [(x, y + s, z) for x, y, z in REST]
    if kind == "slide":
        return [(x, y, z + 3 * s) for x, y, z in REST]
    if kind == "bones":
        return [REST[0], (1, 0, 3 * s), (0, 2, 1.5 * s)]
    if kind == "morph":
        return [REST[0], (1, 4 * s, 0), REST[2]]
    return REST


def check(kind, folder):
    for frame in (0, 15, 30, 60, 80):
        name = "obstacles.ply" if kind == "still" else \
            f"frames/obstacles_{frame:04d}.ply"
        got = sorted(load(f"{folder}/{name}")[0])
        for a, b in zip(got, sorted(expected(kind, frame / 60))):
            assert max(abs(x - y) for x, y in zip(a, b)) < 2e-6, (frame, got)


def corners(path):
    """The triangles as tuples of three corners."""
    x, faces = load(path)
    return [tuple(x[v] for v in face) for face in faces]


def near(a, b):
    return any(all(abs(p - q) <= 1e-5 for k in range(3)
                   for p, q in zip(a[k], b[(k + turn) % 3]))
               for turn in range(3))


def compare(a, b):
    one, other = corners(a), corners(b)
    if not one or len(one) != len(other):
        sys.exit(f"{len(one)} and {len(other)} triangles")
    for k, pair in enumerate(zip(one, other)):
        if not near(*pair):
            sys.exit(f"triangle {k}: {pair[0]} and {pair[1]}")


def main():
    if sys.argv[1] == "same":
        compare(*sys.argv[2:])
    elif sys.argv[1] == "write":
        write_nodes("nodes.gltf", 1)
        write_nodes("two.gltf", 2)
        write_bones()
        write_morph()
        write_fbx("slide.fbx", False)
        write_fbx("bones.fbx", True)
        write_cube()
    else:
        check(*sys.argv[2:])


main()
