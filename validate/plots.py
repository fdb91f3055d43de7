# SPDX-License-Identifier: Apache-2.0
"""Pictures of what build/validate wrote.  usage: python -m validate.plots DIRECTORY"""
import re
import sys

from bench.picture import COLOURS, Page

import matplotlib.pyplot as plt  # picture chooses how it draws
from matplotlib import ticker

PAGE = Page(sys.argv[1], 9)
rows = PAGE.rows
ASIDE = {"loc": "center left", "bbox_to_anchor": (1, 0.5)}


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


def picture(*parts, size, columns=1, name=None):
    """Draws and saves a picture, if there are values of one of the parts: the function
    gets its axes and those of the first part."""
    def drawn(draw):
        found = [series(part) for part in parts]
        if any(found):
            figure, axes = plt.subplots(1, columns, figsize=size)
            draw(axes, found[0])
            for each in figure.axes:
                if each.get_xscale() == "log":
                    plain(each.xaxis)
            PAGE.save(figure, name or parts[0])
        return draw
    return drawn


def value(point):
    return float(point["value"])


def over_theory(point):
    return value(point) / float(point["theory"])


def lines(axes, how, chosen, label, of=value, x="", y="", legend=8, **style):
    """Values over sizes in mm or ms, a line a property. legend: size of its letters, or
    what it is called with."""
    for k, (name, points) in enumerate(chosen):
        look = {"color": COLOURS[k % 8], "markersize": 4, "linewidth": 1, **style}
        if points:
            getattr(axes, how)([1e3 * float(p["size"]) for p in points],
                               [of(p) for p in points], "o-" if k < 8 else "s--",
                               label=label(name), **look)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    if chosen and legend:
        axes.legend(**(legend if isinstance(legend, dict) else {"fontsize": legend}))


def errors(axes, found, label, **how):
    """Relative error over size, where it is not 0."""
    chosen = [(name, [p for p in points if p["theory"] and over_theory(p) != 1])
              for name, points in found]
    lines(axes, "loglog", chosen, label, lambda p: abs(over_theory(p) - 1),
          markersize=3, **how)


def only(found, *words, without=()):
    """The properties that have all words of one kind and none of the other."""
    return [(name, points) for name, points in found.items()
            if all(word in name for word in words) and
            not any(word in name for word in without)]


@picture("cantilever", columns=2, size=(10.5, 3.8))
def _(axes, found):
    left, right = axes
    marks = {"ribbon in warp": ("o", COLOURS[0]),
             "bias strip": ("s", COLOURS[4]),
             "sheet in warp": ("^", COLOURS[2])}
    theory = sorted({(float(name.split("= ")[1]), float(points[0]["theory"]))
                     for name, points in found.items()})
    left.loglog(*zip(*theory), "-", color="black", linewidth=1,
                label="heavy elastica")
    for kind, (mark, colour) in marks.items():
        at = [(float(name.split("= ")[1]), value(points[-1]))
              for name, points in found.items() if name.startswith(kind)]
        if at:
            left.loglog(*zip(*at), mark, color=colour, markersize=5,
                        fillstyle="none", label=kind + ", finest cells")
    plain(left.yaxis)
    left.set_xlabel("Γ = w L³ / D")
    left.set_ylabel("H / W of the tip")
    left.legend(fontsize=8)
    errors(right, found.items(), str, x="cell, mm", y="relative error of H / W",
           legend={"fontsize": 7, **ASIDE})


@picture("layers", columns=2, size=(9.5, 3.6))
def _(axes, found):
    left, right = axes
    for k, (what, label) in enumerate((
            ("floor's share of all weights", "floor's share of all weights"),
            ("share of a sheet in what lies on it", "worst sheet's share"),
            ("least distance of two sheets; of the thickness",
             "least distance over the thickness"))):
        at = sorted((int(name.split()[0]), value(points[0]))
                    for name, points in found.items()
                    if re.fullmatch(r"\d+ sheets; " + what, name))
        left.semilogx(*zip(*at), "o-", color=COLOURS[k], markersize=4,
                      label=label)
    left.set_xlabel("sheets")
    left.set_ylim(0, 1.1)
    left.legend(fontsize=8)
    lines(right, "semilogx", [(name, points) for name, points in only(
              found, without=["cells"]) if name.endswith("Coulomb's")],
          lambda name: name.replace("; way over Coulomb's", ""), x="step, ms",
          y="way over Coulomb's", legend={"fontsize": 6, **ASIDE})
    right.axhline(1, color="black", linewidth=0.8)


@picture("grip", columns=2, size=(9.5, 3.6))
def _(axes, found):
    for each, by, label in zip(axes, ("by cells", "by steps"), ("cell, mm", "step, ms")):
        kinds = sorted({n.split(";")[0] for n in found if by in n})
        for q, kind in enumerate(kinds):
            for k, (name, points) in enumerate(
                    (n, p) for n, p in only(found, "way")
                    if n.startswith(kind + "; " + by) and
                    n.split("; ")[3] == "baraff-witkin"):
                each.loglog([1e3 * float(p["size"]) for p in points],
                            [1e3 * max(value(p), 1e-9)
                             for p in points], ("o-", "s--")[q],
                            color=COLOURS[k], markersize=4, linewidth=1,
                            label=kind + ", " + name.split("; ")[2].split()[0])
        each.axhline(1, color="black", linewidth=0.8)
        each.set_xlabel(label)
        each.set_ylabel("way in 0.5 s, mm")
    axes[1].legend(fontsize=6, **ASIDE)


@picture("belt", size=(6.5, 3.8))
def _(axes, found):
    lines(axes, "semilogx", only(found, "law", without=["cells"]),
          lambda name: "; ".join(name.split("; ")[:3]).replace(
              "; logarithm of tensions' quotient over the law's", ""),
          x="step, ms", y="log of tensions' quotient over μ θ",
          legend={"fontsize": 6, **ASIDE})
    axes.axhline(1, color="black", linewidth=0.8)


@picture("impact", columns=2, size=(10, 6))
def _(axes, found):
    below = {"fontsize": 6, "loc": "upper center", "bbox_to_anchor": (0.5, -0.13)}
    lines(axes[0], "semilogx", only(found, "restitution"),
          lambda name: name.replace("; restitution", ""), x="step, ms",
          y="restitution", legend=below)
    lines(axes[1], "semilogx", only(found, "lost"),
          lambda name: name.replace(" along the floor", "").replace(
              "; speed lost over the law's", ""), x="step, ms",
          y="speed lost over the law's", legend=below)
    axes[1].axhline(1, color="black", linewidth=0.8)


@picture("converge", columns=2, size=(9.5, 3.6))
def _(axes, found):
    for each, by, label in zip(axes, ("by steps", "by cells"), ("step, ms", "cell, mm")):
        lines(each, "loglog", only(found, by, "rms"),
              lambda name, by=by: name.replace(f"; {by}; rms error", ""),
              lambda p: 1e3 * value(p), x=label, y="rms error, mm", legend=7)


@picture("cylinder", size=(5.5, 3.6))
def _(axes, found):
    errors(axes, found.items(),
           lambda name: name.split(" degrees")[0].replace("bent at ", "") + "°",
           x="cell, mm; κ = 10 / m", y="relative error of ½ D κ²")


@picture("buckling", "bendtwist", "stickslip", columns=3, size=(12, 4.2), name="strips")
def _(axes, _):
    """What slender strips do, over theory."""
    for each, part in zip(axes, ("buckling", "bendtwist", "stickslip")):
        chosen = [(n, p) for n, p in series(part).items()
                  if float(p[0]["theory"]) > 1e-6 and
                  not re.search("greatest|the same", n)]
        lines(each, "semilogx", chosen, str, over_theory, x="cell, mm",
              legend={"fontsize": 6, "loc": "upper center",
                      "bbox_to_anchor": (0.5, -0.15)})
        each.axhline(1, color="black", linewidth=0.8)
        each.set_title(part)
    axes[0].set_ylabel("over theory")


@picture("meeting", size=(5.5, 3.6))
def _(axes, found):
    chosen = [(n, p) for n, p in only(found, "by steps")
              if n.endswith("angular momentum lost")]
    lines(axes, "loglog", chosen, lambda name: name.split("; ")[2], x="step, ms",
          y="angular momentum lost in 0.2 s, of the start's", linewidth=None)


@picture("tension", size=(5.5, 3.6))
def _(axes, found):
    errors(axes, found.items(), lambda name: name.replace(" of a hanging strip", ""),
           x="cell, mm", y="relative error")


@picture("motion", columns=2, size=(9.5, 3.6))
def _(axes, found):
    errors(axes[0], only(found, "free fall"), lambda name: name.split("; ")[1],
           x="step, ms", y="relative error of the depth after 0.5 s")
    for k, (name, points) in enumerate(only(found, "kept a period")):
        steps = [1e3 * float(p["size"]) for p in points]
        axes[1].loglog(steps, [1 - value(p) for p in points], "o-", color=COLOURS[k],
                       markersize=4, label=name.split("; ")[2])
        if name.endswith("baraff-witkin"):
            ratio = found.get("pendulum; baraff-witkin over exact backward Euler", [])
            axes[1].loglog(steps, [1 - value(p) / value(r)
                                   for p, r in zip(points, ratio)], "--",
                           color="black", linewidth=1, label="exact backward Euler")
    axes[1].set_xlabel("step, ms")
    axes[1].set_ylabel("part of the swing lost in a period")
    axes[1].legend(fontsize=8)


@picture("cusick", size=(5.5, 3.4))
def _(axes, found):
    lines(axes, "plot", only(found, "drape coefficient"), str, x="cell, mm",
          y="drape coefficient, %", legend=None, color=COLOURS[0], linewidth=None)
    axes.set_ylim(50, 90)


FABRICS = sum(name.startswith("drape coefficient") for name in series("fabrics"))


@picture("fabrics", size=(8, 0.9 + 0.28 * FABRICS))
def _(axes, found):
    """Values at the finest cells beside published bands, where a row's theory and bar are
    the middle and half the width of one."""
    chosen = [(n.split("; ")[-1], p[-1]) for n, p in only(found, "drape coefficient")]
    band = {r["property"].split("; ")[-1]: (float(r["theory"]), float(r["bar"]))
            for r in rows("properties-fabrics")
            if r["property"].startswith("drape") and r["theory"] and r["bar"]}
    for k, (fabric, point) in enumerate(chosen):
        if fabric in band:
            middle, half = band[fabric]
            axes.barh(k, 2 * half, left=middle - half, height=0.6,
                      color="#cccccc")
        axes.plot(value(point), k, "o", color=COLOURS[0])
    axes.set_yticks(range(len(chosen)), [fabric for fabric, _ in chosen])
    axes.set_ylim(len(chosen) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.set_xlabel("drape coefficient, %; grey: published band")
