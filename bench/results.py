# SPDX-License-Identifier: Apache-2.0
"""What bench/scenes.sh left, and the paper's numbers beside it."""
import csv
import json
import os
import re

# Rows of the plan that collisions fill.
COLLISION = ["features", "proximity", "front, obstacles", "front, self"]


def order(scene):
    sizes = ["20k", "500k", "2m"]
    bodies = ["buddha", "lion", "dragon"]
    body, _, size = scene.partition("_")
    return (sizes.index(size) if size in sizes else 9,
            bodies.index(body) if body in bodies else 9, scene)


class Results:
    """The results in a folder: runs[scene][mode], and some text files."""

    def __init__(self, folder):
        self.folder = folder
        self.runs = {}
        for name in os.listdir(folder):
            if name.endswith(".json"):
                scene, mode = name[:-5].rsplit(".", 1)
                with open(os.path.join(folder, name)) as file:
                    self.runs.setdefault(scene, {})[mode] = json.load(file)
        self.scenes = sorted(self.runs, key=order)
        # scenes of the table of contact; all others are in the paper's figures
        self.contact = self.text("contact").split()
        rows = [line.split("\t") for line in self.text("machine").splitlines()]
        self.machine = dict(rows)

    def text(self, name):
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            return ""
        with open(path) as file:
            return file.read().strip()

    def ours(self, contact=False):
        """The runs of the paper's scenes, or of those rich in contact."""
        return [(s, self.runs[s]["ours"]) for s in self.scenes
                if "ours" in self.runs[s] and contact == (s in self.contact)]


def plan_bytes(run):
    return {row["stage"]: row["bytes"] for row in run["plan"]}


def explicit_bytes(explicit, start, implicit, borrowed):
    """The memory that a whole explicit run would take: that of its first steps,
    and for streams that collisions fill the growth of the implicit run since
    its start, with what that run borrowed from its solver."""
    rows = {stage: count + max(0, implicit[stage] - start[stage])
            if stage in COLLISION else count
            for stage, count in explicit.items()}
    rows["scratch"] += borrowed
    return rows


def memory(results):
    """Yields (scene, integration, bytes by stage) from the plans."""
    for scene, run in results.ours():
        implicit = plan_bytes(run)
        explicit = results.runs[scene].get("explicit")
        start = results.runs[scene].get("start")
        if explicit and start:
            yield scene, "explicit", explicit_bytes(
                plan_bytes(explicit), plan_bytes(start), implicit,
                run["memory"].get("borrowed_bytes", 0))
        yield scene, "implicit", implicit


def device_mb(results, scene):
    """The device's memory in use while the scene ran, minus that before, MB."""
    samples = [int(word) for word in
               results.text(scene + ".ours.memory").split() if word.isdigit()]
    return (max(samples) - min(samples)) * 1.048576 if samples else ""


def machine_folder(machine):
    """The folder's name for a machine, such as h200 for "NVIDIA H200"."""
    words = machine.get("gpu", "no device").lower().split()
    memory = re.compile(r"\d+gb|hbm\w+|nvidia|geforce")
    return "-".join(w for w in words if not memory.fullmatch(w))


def paper_rows(folder):
    """{scene: row} of the paper's numbers, as text."""
    with open(os.path.join(folder, "tang2013.csv")) as file:
        lines = [line for line in file if not line.startswith("#")]
    return {row["scene"]: row for row in csv.DictReader(lines)}
