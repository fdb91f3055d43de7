# SPDX-License-Identifier: Apache-2.0
"""Whether app/scenes/README.md says the truth on ranges and defaults.

usage: tests/defaults.py DRAPE README; ends with `N passed, N failed`.
A range is what the tool says where a number is beyond all bounds. A default
of the scene's own keys is what report.json says of a scene without them; any
other default, given, must change nothing in a run, and another value must.
"""
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile

drape = os.path.abspath(sys.argv[1])
counts = [0, 0]


def check(name, good):
    counts[not good] += 1
    print(("ok " if good else "not ok ") + name)


def sections(text):
    """{name: rows of cells} of the tables that have ranges and defaults."""
    name, tables = "", {}
    for line in text.splitlines():
        title = re.fullmatch(r"## (?:The|An|A) (\w+)|\*\*(\w+)\*\*.*", line)
        if title:
            name = title[1] or title[2]
        cells = [c.strip() for c in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 4:
            tables.setdefault(name, []).append(cells)
    return tables


def number(text):
    base, _, power = text.partition("^")
    if "/" in text:
        return eval(text, {})
    return float(base) ** int(power) if power else float(text)


def value(text):
    """The default as a value, or None where it is described in words."""
    literal = re.match(r"`([^`]*)`", text)
    if literal:
        return json.loads(literal[1])
    if text in ("true", "false"):
        return text == "true"
    if re.fullmatch(r"[-0-9.^/]+", text):
        return number(text)
    return None


def bounds(text):
    """lo, hi of a range, or None."""
    text = text.removesuffix(" each")
    if text.startswith("±"):
        return -number(text[1:]), number(text[1:])
    parts = text.split(" … ")
    return tuple(map(number, parts)) if len(parts) == 2 else None


# What a key needs around it to have an effect, as parts of the scene below.
AROUND = {
    ("wind", None): {"wind": {"velocity": [2, 0, 1]}},
    ("cloth", "particles"): {"start": {"at": [0, 2, 0]}},
    ("start", "folds"): {"start": {"shape": "hung", "depth": 0.02}},
    ("start", "depth"): {"start": {"shape": "hung", "folds": 3}},
    ("start", "radius"): {"start": {"shape": "rolled", "gap": 0.03}},
    ("start", "gap"): {"start": {"shape": "rolled", "radius": 0.06}},
    ("obstacle", "extent"): {"obstacle": {"shape": "box"}},
    ("obstacle", "length"): {"obstacle": {"shape": "capsule"}},
    ("obstacle", "throat"): {"obstacle": {"shape": "funnel"}},
    ("obstacle", "height"): {"obstacle": {"shape": "statue"}},
    ("obstacle", "axis"): {"obstacle": {"angle": 30}},
    ("obstacle", "friction"): {"material": {"friction": 0}},
    ("material", "friction"): {"obstacle": {"friction": 0}},
}
# The pattern of a garment: one panel, 0.1 m wide.
SQUARE = {"vertices": [[0, 0], [10, 0], [10, 10], [0, 10]],
          "edges": [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]}
# A small cloth, but where its size is the question.
SMALL = {"particles": [9, 9], "size": [0.4, 0.4]}


def scene(section, key, given):
    """A sheet above a ball; `given` {} or {key: value} in its section."""
    parts = {name: {} for name in ("wind", "camera", "cloth", "start",
                                   "material", "obstacle", "look", "garment")}
    parts["start"] = {"at": [0, 0.61, 0]}
    parts["obstacle"] = {"shape": "sphere", "at": [0.1, 0.1, 0], "detail": 12}
    for name, change in {**AROUND.get((section, None), {}),
                         **AROUND.get((section, key), {})}.items():
        parts[name].update(change)
    parts["cloth"] = {k: v for k, v in SMALL.items() if k != key}
    if section in parts:
        parts[section].pop(key, None)
        parts[section].update(given)
    cloth = dict(parts["cloth"], start=parts["start"],
                 material=parts["material"], look=parts["look"])
    whole = {"wind": parts["wind"], "camera": parts["camera"],
             "cloths": [cloth], "obstacles": [parts["obstacle"]],
             "allow_intersecting": True, "sleep": False}
    if section == "garment":
        with open("square.json", "w") as file:
            json.dump({"pattern": {"panels": {"square": SQUARE}},
                       "properties": {"units_in_meter": 100}}, file)
        garment = dict(parts["garment"], pattern="square.json")
        whole = dict(whole, cloths=[], garments=[garment])
        del whole["wind"]  # panels do not feel it
    return dict(whole, **given) if section == "scene" else whole


def run(what, *options):
    """Exit status, the words of a refusal, and what the run left."""
    with open("scene.json", "w") as file:
        json.dump(what, file)
    done = subprocess.run([drape, "run", "scene.json", "--out", "out",
                           "--force", "--no-obj", *options], capture_output=True,
                          text=True)
    return done.returncode, done.stderr


def outcome(what):
    """All that a run of a few frames computes, as a hash; or its refusal."""
    status, words = run(what, "--frames", "8", "--every", "8")
    if status > 1:
        return words
    with open("out/report.json") as file:
        report = json.load(file)
    for step in report["steps"]:
        del step["seconds"]
    left = json.dumps([report["steps"], report.get("camera"), report["picture"],
                       report["bodies"]]).encode()
    for name in ["obstacles.ply", "frames/cloth_0000.ply"]:
        with open(os.path.join("out", name), "rb") as file:
            left += file.read()
    return hashlib.sha256(left).hexdigest()


def other(default):
    """Another value than this default."""
    if isinstance(default, bool):
        return not default
    if isinstance(default, list):
        return [1.25 * d + 0.25 if d != int(d) else d + 1 for d in default]
    return round(1.25 * default) if default > 8 else 1.25 * default + 0.01 * (
        default == 0)


def check_range(section, key, text, default):
    beyond = [1e300] * len(default) if isinstance(default, list) else 1e300
    if bounds(text) and default is not None:
        lo, hi = bounds(text)
        _, words = run(scene(section, key, {key: beyond}))
        said = re.search(r"number from (\S+) to (\S+)$", words.strip())
        check(f"{section} {key}: from {lo:g} to {hi:g}", said is not None and
              (float(said[1]), float(said[2])) == (lo, hi))


def check_default(section, key, default, settings):
    if section == "scene":
        check(f"{key}: {default}", settings.get(key) == default)
        return
    if isinstance(default, str):
        return
    without = outcome(scene(section, key, {}))
    check(f"{section} {key}: {default} is the default",
          without == outcome(scene(section, key, {key: default})))
    check(f"{section} {key}: it counts",
          without != outcome(scene(section, key, {key: other(default)})))


def main():
    with open(sys.argv[2]) as file:
        tables = sections(file.read())
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        run({"cloths": [{"particles": [2, 2]}]})
        with open("out/report.json") as file:
            settings = json.load(file)["settings"]
        for section, rows in tables.items():
            for keys, _, span, text in rows:
                key = re.fullmatch(r"`(\w+)`", keys)
                default = value(text)
                if key and default is not None:
                    check_range(section, key[1], span, default)
                    check_default(section, key[1], default, settings)
        os.chdir("/")
    check("every table was read", len(tables) == 9)
    told = {name for row in tables["scene"]
            for name in re.findall(r"`(\w+)`", row[0])}
    check("every setting is in the table", set(settings) <= told)
    print(f"{counts[0]} passed, {counts[1]} failed")
    sys.exit(counts[1] > 0)


main()
