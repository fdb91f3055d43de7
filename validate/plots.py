# SPDX-License-Identifier: Apache-2.0
"""Pictures of what build/validate wrote.  usage: plots.py DIRECTORY"""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..",
                                "bench"))
from picture import COLOURS, Page  # noqa: E402: it lies in bench/

import matplotlib.pyplot as plt  # noqa: E402: picture chooses how it draws
from matplotlib import ticker  # noqa: E402

PAGE = Page(sys.argv[1], 9)
rows = PAGE.rows


def series(part, bits="64"):
    """Property to its rows with a value, of one precision."""
    found = {}
    for row in rows("values-" + part):
        if row["bits"] == bits and row["value"]:
            found.setdefault(row["property"], []).append(row)
    return found


def plain(axis):
    """Numbers as they are, not as powers of ten."""
    axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axis.set_minor_locator(ticker.LogLocator(subs=(2, 5)))
    axis.set_minor_formatter(ticker.FormatStrFormatter("%g"))


def save(figure, name):
    for axes in figure.axes:
        if axes.get_xscale() == "log":
            plain(axes.xaxis)
    PAGE.save(figure, name)


def errors(axes, part, wanted, label):
    """Relative error over size, of the properties that `wanted` takes."""
    chosen = [(name, points) for name, points in series(part).items()
              if wanted(name)]
    for k, (name, points) in enumerate(chosen):
        at = [(1e3 * float(p["size"]),
               abs(float(p["value"]) / float(p["theory"]) - 1))
              for p in points if p["theory"]]
        at = [(x, y) for x, y in at if y > 0]
        if at:
            axes.loglog(*zip(*at), "o-" if k < 8 else "s--", color=COLOURS[k % 8], markersize=3,
                        linewidth=1, label=label(name))
    if chosen:
        axes.legend(fontsize=8)


def cantilever():
    found = series("cantilever")
    if not found:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 3.8))
    marks = {"ribbon in warp": ("o", COLOURS[0]),
             "bias strip": ("s", COLOURS[4]),
             "sheet in warp": ("^", COLOURS[2])}
    theory = sorted({(float(name.split("= ")[1]), float(points[0]["theory"]))
                     for name, points in found.items()})
    left.loglog(*zip(*theory), "-", color="black", linewidth=1,
                label="heavy elastica")
    for kind, (mark, colour) in marks.items():
        at = [(float(name.split("= ")[1]), float(points[-1]["value"]))
              for name, points in found.items() if name.startswith(kind)]
        if at:
            left.loglog(*zip(*at), mark, color=colour, markersize=5,
                        fillstyle="none", label=kind + ", finest cells")
    plain(left.yaxis)
    left.set_xlabel("Γ = w L³ / D")
    left.set_ylabel("H / W of the tip")
    left.legend(fontsize=8)
    errors(right, "cantilever", lambda name: True, lambda name: name)
    right.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    right.set_xlabel("cell, mm")
    right.set_ylabel("relative error of H / W")
    save(figure, "cantilever")


def cylinder():
    if not series("cylinder"):
        return
    figure, axes = plt.subplots(figsize=(5.5, 3.6))
    errors(axes, "cylinder", lambda name: True,
           lambda name: name.split(" degrees")[0].replace("bent at ", "") + "°")
    axes.set_xlabel("cell, mm; κ = 10 / m")
    axes.set_ylabel("relative error of ½ D κ²")
    save(figure, "cylinder")


def tension():
    if not series("tension"):
        return
    figure, axes = plt.subplots(figsize=(5.5, 3.6))
    errors(axes, "tension", lambda name: True,
           lambda name: name.replace(" of a hanging strip", ""))
    axes.set_xlabel("cell, mm")
    axes.set_ylabel("relative error")
    save(figure, "tension")


def motion():
    found = series("motion")
    if not found:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    errors(left, "motion", lambda name: name.startswith("free fall"),
           lambda name: name.split("; ")[1])
    left.set_xlabel("step, ms")
    left.set_ylabel("relative error of the depth after 0.5 s")
    for k, (name, points) in enumerate(
            (n, p) for n, p in found.items() if "kept a period" in n):
        right.loglog([1e3 * float(p["size"]) for p in points],
                     [1 - float(p["value"]) for p in points], "o-",
                     color=COLOURS[k], markersize=4, label=name.split("; ")[2])
        if name.endswith("baraff-witkin"):
            ratio = found.get("pendulum; baraff-witkin over exact backward "
                              "Euler", [])
            exact = [float(p["value"]) / float(r["value"])
                     for p, r in zip(points, ratio)]
            right.loglog([1e3 * float(p["size"]) for p in points],
                         [1 - e for e in exact], "--", color="black",
                         linewidth=1, label="exact backward Euler")
    right.set_xlabel("step, ms")
    right.set_ylabel("part of the swing lost in a period")
    right.legend(fontsize=8)
    save(figure, "motion")


def bars(part, wanted, unit, name):
    """Values at the finest cells beside published bands, where a row's theory
    and bar are the middle and half the width of one."""
    found = [(n, p[-1]) for n, p in series(part).items() if wanted(n)]
    if not found:
        return
    figure, axes = plt.subplots(figsize=(8, 0.9 + 0.28 * len(found)))
    band = {r["property"].split("; ")[-1]: (float(r["theory"]), float(r["bar"]))
            for r in rows("properties-" + part)
            if wanted(r["property"]) and r["theory"] and r["bar"]}
    for k, (n, point) in enumerate(found):
        fabric = n.split("; ")[-1]
        if fabric in band:
            middle, half = band[fabric]
            axes.barh(k, 2 * half, left=middle - half, height=0.6,
                      color="#cccccc")
        axes.plot(float(point["value"]), k, "o", color=COLOURS[0])
    axes.set_yticks(range(len(found)), [n.split("; ")[-1] for n, _ in found])
    axes.set_ylim(len(found) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.set_xlabel(unit)
    save(figure, name)


def cusick():
    found = series("cusick")
    if not found:
        return
    figure, axes = plt.subplots(figsize=(5.5, 3.4))
    for name, points in found.items():
        if name.startswith("drape"):
            axes.plot([1e3 * float(p["size"]) for p in points],
                          [float(p["value"]) for p in points], "o-",
                          color=COLOURS[0], markersize=4)
    axes.set_xlabel("cell, mm")
    axes.set_ylabel("drape coefficient, %")
    axes.set_ylim(50, 90)
    save(figure, "cusick")


def strips():
    """What slender strips do, over theory."""
    parts = [("buckling", "cell, mm"), ("bendtwist", "cell, mm"),
             ("stickslip", "cell, mm")]
    if not any(series(part) for part, _ in parts):
        return
    figure, all_axes = plt.subplots(1, 3, figsize=(12, 4.2))
    for axes, (part, label) in zip(all_axes, parts):
        chosen = [(n, p) for n, p in series(part).items()
                  if float(p[0]["theory"]) > 1e-6 and
                  not re.search("greatest|the same", n)]
        for k, (name, points) in enumerate(chosen):
            axes.semilogx([1e3 * float(p["size"]) for p in points],
                          [float(p["value"]) / float(p["theory"])
                           for p in points], "o-", color=COLOURS[k],
                          markersize=4, linewidth=1, label=name)
        axes.axhline(1, color="black", linewidth=0.8)
        axes.set_xlabel(label)
        axes.set_title(part)
        axes.legend(fontsize=6, loc="upper center",
                    bbox_to_anchor=(0.5, -0.15))
    all_axes[0].set_ylabel("over theory")
    save(figure, "strips")


def meeting():
    found = [(n, p) for n, p in series("meeting").items()
             if "by steps" in n and n.endswith("angular momentum lost")]
    if not found:
        return
    figure, axes = plt.subplots(figsize=(5.5, 3.6))
    for k, (name, points) in enumerate(found):
        axes.loglog([1e3 * float(p["size"]) for p in points],
                    [float(p["value"]) for p in points], "o-",
                    color=COLOURS[k], markersize=4, label=name.split("; ")[2])
    axes.set_xlabel("step, ms")
    axes.set_ylabel("angular momentum lost in 0.2 s, of the start's")
    axes.legend(fontsize=8)
    save(figure, "meeting")


def steps(axes, chosen, label, value=float):
    """Values over steps in ms, a line a property."""
    for k, (name, points) in enumerate(chosen):
        axes.semilogx([1e3 * float(p["size"]) for p in points],
                      [value(p["value"]) for p in points],
                      "o-" if k < 8 else "s--", color=COLOURS[k % 8],
                      markersize=4, linewidth=1, label=label(name))
    axes.set_xlabel("step, ms")
    if chosen:
        axes.legend(fontsize=7)


def layers():
    found = series("layers")
    if not found:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    for k, (what, label) in enumerate((
            ("floor's share of all weights", "floor's share of all weights"),
            ("share of a sheet in what lies on it", "worst sheet's share"),
            ("least distance of two sheets; of the thickness",
             "least distance over the thickness"))):
        at = sorted((int(name.split()[0]), float(points[0]["value"]))
                    for name, points in found.items()
                    if re.fullmatch(r"\d+ sheets; " + what, name))
        left.semilogx(*zip(*at), "o-", color=COLOURS[k], markersize=4,
                      label=label)
    left.set_xlabel("sheets")
    left.set_ylim(0, 1.1)
    left.legend(fontsize=8)
    steps(right, [(n, p) for n, p in found.items()
                  if n.endswith("Coulomb's") and "cells" not in n],
          lambda name: name.replace("; way over Coulomb's", ""))
    right.axhline(1, color="black", linewidth=0.8)
    right.set_ylabel("way over Coulomb's")
    right.legend(fontsize=6, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, "layers")


def grip():
    found = series("grip")
    if not found:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    for axes, by, label in ((left, "by cells", "cell, mm"),
                            (right, "by steps", "step, ms")):
        kinds = sorted({n.split(";")[0] for n in found if by in n})
        for q, kind in enumerate(kinds):
            for k, (name, points) in enumerate(
                    (n, p) for n, p in found.items()
                    if n.startswith(kind + "; " + by) and "way" in n and
                    n.split("; ")[3] == "baraff-witkin"):
                axes.loglog([1e3 * float(p["size"]) for p in points],
                            [1e3 * max(float(p["value"]), 1e-9)
                             for p in points], ("o-", "s--")[q],
                            color=COLOURS[k], markersize=4, linewidth=1,
                            label=kind + ", " + name.split("; ")[2].split()[0])
        axes.axhline(1, color="black", linewidth=0.8)
        axes.set_xlabel(label)
        axes.set_ylabel("way in 0.5 s, mm")
    right.legend(fontsize=6, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, "grip")


def belt():
    found = series("belt")
    chosen = [(n, p) for n, p in found.items()
              if "law" in n and "cells" not in n]
    if not chosen:
        return
    figure, axes = plt.subplots(figsize=(6.5, 3.8))
    steps(axes, chosen, lambda name: "; ".join(name.split("; ")[:3]).replace(
        "; logarithm of tensions' quotient over the law's", ""))
    axes.axhline(1, color="black", linewidth=0.8)
    axes.set_ylabel("log of tensions' quotient over μ θ")
    axes.legend(fontsize=6, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, "belt")


def impact():
    found = series("impact")
    if not found:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 6))
    steps(left, [(n, p) for n, p in found.items() if "restitution" in n],
          lambda name: name.replace("; restitution", ""))
    left.set_ylabel("restitution")
    left.legend(fontsize=6, loc="upper center", bbox_to_anchor=(0.5, -0.13))
    steps(right, [(n, p) for n, p in found.items() if "lost" in n],
          lambda name: name.replace(" along the floor", "").replace(
              "; speed lost over the law's", ""))
    right.axhline(1, color="black", linewidth=0.8)
    right.set_ylabel("speed lost over the law's")
    right.legend(fontsize=6, loc="upper center", bbox_to_anchor=(0.5, -0.13))
    save(figure, "impact")


def converge():
    found = series("converge")
    if not found:
        return
    figure, all_axes = plt.subplots(1, 2, figsize=(9.5, 3.6))
    for axes, by in zip(all_axes, ("by steps", "by cells")):
        for k, (name, points) in enumerate(
                (n, p) for n, p in found.items() if by in n and "rms" in n):
            axes.loglog([1e3 * float(p["size"]) for p in points],
                        [1e3 * float(p["value"]) for p in points], "o-",
                        color=COLOURS[k], markersize=4, linewidth=1,
                        label=name.replace(f"; {by}; rms error", ""))
        axes.set_xlabel("step, ms" if by == "by steps" else "cell, mm")
        axes.set_ylabel("rms error, mm")
        axes.legend(fontsize=7)
    save(figure, "converge")


cantilever()
layers()
grip()
belt()
impact()
converge()
cylinder()
strips()
meeting()
tension()
motion()
cusick()
bars("fabrics", lambda name: name.startswith("drape coefficient"),
     "drape coefficient, %; grey: published band", "fabrics")
