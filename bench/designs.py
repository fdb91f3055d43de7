#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Garments that nobody has chosen: designs drawn at random by GarmentCode's own
sampler, sewn on its mean body by `drape sew`. app/patterns/README.md §11

usage: bench/designs.py DRAPE GARMENTCODE OUT FIRST LAST [CELL [OPTION...]]

GARMENTCODE is a clone of github.com/maria-korosteleva/GarmentCode (MIT), whose own
`pygarment` is used; `pip install pygarment trimesh` has what that needs. Draws a design
of each seed from FIRST to LAST to OUT/designN_specification.json, sews it by cells of
CELL m (default: 0.01) with these options, and adds a row to OUT/designs.csv. Designs
with trousers are sewn on the body with its legs apart. The exit status is 1 if in some
frame cloth goes through cloth or a body.
"""
import csv
import json
import os
import random
import re
import subprocess
import sys
import time
import warnings

HEAD = ["seed", "upper", "band", "lower", "collar", "panels", "triangles", "seams",
        "closed", "open mm", "pairs", "steps", "seconds", "end"]


def draw(code, out, seed):
    """A design as GarmentCode's data set draws it: from the first of 100 draws that
    is a garment. Returns its file, its parameters and its number of panels."""
    import pygarment
    from assets.bodies.body_params import BodyParameters
    from assets.garment_programs.meta_garment import (
        IncorrectElementConfiguration,
        MetaGarment,
        TotalLengthError,
    )
    from pattern_sampler import assert_param_combinations

    body = BodyParameters(os.path.join(code, "assets/bodies/mean_all.yaml"))
    sampler = pygarment.DesignSampler(
        os.path.join(code, "assets/design_params/default.yaml"))
    random.seed(seed)
    for _ in range(100):
        design = sampler.randomize()
        try:
            assert_param_combinations(design)
            garment = MetaGarment(f"design{seed}", body, design)
            garment.assert_total_length()
        except (Exception, IncorrectElementConfiguration, TotalLengthError):
            continue  # an empty one, too long, or one that its programs cannot draw
        if not garment.is_self_intersecting():
            pattern = garment.assembly()
            pattern.serialize(out, to_subfolder=False, with_3d=False, with_text=False,
                              view_ids=False)
            file = os.path.join(out, f"design{seed}_specification.json")
            return file, design, len(pattern.pattern["panels"])
    return None


def body(code, out, name):
    """The body in metres, as PLY."""
    import trimesh

    path = os.path.join(out, name + ".ply")
    if not os.path.exists(path):
        mesh = trimesh.load(os.path.join(code, f"assets/bodies/{name}.obj"),
                            process=False, maintain_order=True)
        if mesh.vertices.max() > 10:
            mesh.apply_scale(0.01)
        mesh.export(path)
    return path


def sew(drape, file, mesh, cell, options):
    """Sews a design; what becomes of it, as the end of a row."""
    folder = file.replace("_specification.json", "")
    begin = time.monotonic()
    done = subprocess.run(
        [drape, "sew", file, "--body", mesh, "--cell", str(cell), "--out", folder,
         "--force", "--no-picture", *options],
        capture_output=True, text=True, check=False)
    seconds = f"{time.monotonic() - begin:.0f}"
    if done.returncode not in (0, 1):
        return ["", "", "", "", "", "", seconds, done.stderr.strip().splitlines()[-1]]
    with open(os.path.join(folder, "sew.json"), encoding="utf-8") as told:
        told = json.load(told)
    with open(os.path.join(folder, "report.json"), encoding="utf-8") as report:
        triangles = next(body["first_triangle"] for body in json.load(report)["bodies"]
                         if body["kind"] == "obstacle")
    open_by = max((seam["gap_m"] for seam in told["seams"] if not seam["closed"]),
                  default=0)
    end = re.findall(r"steps, [0-9.]+ s, ([a-z ]+);", done.stdout + done.stderr)
    return [triangles, len(told["seams"]),
            sum(seam["closed"] is not None for seam in told["seams"]),
            f"{1e3 * open_by:.2g}", sum(frame["pairs"] for frame in told["frames"]),
            told["steps"], seconds, end[-1] if end else ""]


def main(drape, code, out, first, last, cell="0.01", *options):
    if not os.path.isdir(os.path.join(code, "assets/garment_programs")):
        sys.exit(f"designs: {code}: no clone of GarmentCode")
    sys.path.insert(0, code)
    warnings.simplefilter("ignore")  # of rotations that are a quarter turn
    os.makedirs(out, exist_ok=True)
    crossed = False
    with open(os.path.join(out, "designs.csv"), "a", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        if not file.tell():
            rows.writerow(HEAD)
        for seed in range(int(first), int(last) + 1):
            drawn = draw(code, out, seed)
            if not drawn:
                continue
            path, design, panels = drawn
            kind = [design["meta"][key]["v"] for key in ("upper", "wb", "bottom")]
            collar = design["collar"]["component"]["style"]["v"] if kind[0] else None
            mesh = body(code, out,
                        "mean_all_apart" if kind[2] == "Pants" else "mean_all")
            row = [seed, *kind, collar, panels, *sew(drape, path, mesh, cell, options)]
            rows.writerow(row)
            file.flush()
            print(*row, sep=",", flush=True)
            crossed |= row[10] not in ("", 0)
    return 1 if crossed else 0


if __name__ == "__main__":
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
