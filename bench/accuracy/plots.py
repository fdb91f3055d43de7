# SPDX-License-Identifier: Apache-2.0
"""Pictures of what build/accuracy wrote, and the table of settings.
usage: python -m bench.accuracy.plots DIRECTORY"""
import os
import sys

import matplotlib.pyplot as plt

from bench.picture import Page, number

HERE = sys.argv[1]
COLOUR = {"euler": "#b0672a", "midpoint": "#7a9a2e", "verlet": "#1b7f5c",
          "rk4": "#6a4fa3", "baraff-witkin": "#c1272d", "choi-ko": "#1f5fa8"}
PAGE = Page(HERE, 8)
rows, save = PAGE.rows, PAGE.save


def curve(axes, points, error, label, **style):
    """Draws the points that ended well, from long steps to short ones."""
    points = [r for r in points if r["end"] in ("stable", "unconverged")]
    points.sort(key=lambda r: -number(r, "dt"))
    if points:
        axes.loglog([number(r, "seconds") for r in points],
                    [max(number(r, error), 1e-12) for r in points],
                    label=label, markersize=3, linewidth=1, **style)


def work():
    """Draws time against error: a picture of positions for each scene, one of
    the other errors, one of the solver's settings."""
    table = rows("work")
    scenes = list(dict.fromkeys(r["scene"] for r in table))
    if not scenes:
        return

    def chosen(scene, m, precision, precond="", tolerance=None):
        return [r for r in table if r["scene"] == scene and
                r["integrator"] == m and r["precision"] == precision and
                r["precond"] == precond and
                (tolerance is None or number(r, "tolerance") == tolerance)]

    def six(axes, scene, error):
        for m in COLOUR:
            explicit = m not in ("baraff-witkin", "choi-ko")
            for bits, line in (("32", "-"), ("64", ":")):
                points = chosen(scene, m, bits) if explicit else chosen(
                    scene, m, bits, "multigrid",
                    1e-3 if bits == "32" else 1e-8)
                curve(axes, points, error, "%s, %s" % (m, bits),
                      color=COLOUR[m], linestyle=line, marker="o")
        axes.set_xlabel("processor seconds for 0.1 s")

    figure, axes = plt.subplots(1, len(scenes), figsize=(10.5, 4),
                                sharey=True, squeeze=False)
    axes = axes[0]
    for a, scene in zip(axes, scenes):
        six(a, scene, "rms m")
        a.set_title(scene)
    axes[0].set_ylabel("rms distance to the converged run, m")
    save(figure, "work", axes[0])

    errors = ("energy J", "strain", "pin m")
    figure, axes = plt.subplots(1, len(errors), figsize=(10.5, 3.6))
    for a, error in zip(axes, errors):
        six(a, "hanging", error)
        a.set_title("hanging: " + error)
    save(figure, "errors", axes[0])

    figure, axes = plt.subplots(1, 2, figsize=(9, 4), sharey=True)
    for a, m in zip(axes, ("baraff-witkin", "choi-ko")):
        for precond, line in (("multigrid", "-"), ("jacobi", "--")):
            for tolerance, colour in ((1e-2, "#d98c3f"), (1e-3, "#444444"),
                                      (1e-5, "#1f5fa8")):
                curve(a, chosen("hanging", m, "32", precond, tolerance),
                      "rms m", "%s, %g" % (precond, tolerance),
                      color=colour, linestyle=line, marker="o")
        a.set_title("hanging, %s: preconditioner, tolerance" % m)
        a.set_xlabel("processor seconds for 0.1 s")
    axes[0].set_ylabel("rms distance, m")
    axes[1].legend(fontsize=7)
    save(figure, "solver")


OUTCOME = {"stable": "#4b9b6e", "unconverged": "#d9c34a",
           "refused": "#cfd3d8", "diverged": "#d97b3f",
           "not finite": "#000000"}


def stability():
    table = rows("stability")
    if not table:
        return
    figure, axes = plt.subplots(2, 6, figsize=(11, 4.6), sharex=True,
                                sharey=True)
    for i, damping in enumerate(("0", "0.0001")):
        for a, m in zip(axes[i], COLOUR):
            cells = [r for r in table if r["integrator"] == m and
                     r["damping s"] == damping]
            for r in cells:
                a.scatter(number(r, "stretch N/m"), number(r, "dt"), s=40,
                          marker="s", color=OUTCOME[r["end"]], linewidths=0)
                mark = {"diverged": "x", "missed": "*"}.get(
                    r["without the limit"])
                if mark:
                    a.scatter(number(r, "stretch N/m"), number(r, "dt"), s=12,
                              marker=mark, color="black", linewidths=0.7)
            limit = sorted({(number(r, "stretch N/m"), number(r, "limit s"))
                            for r in cells})
            limit = [p for p in limit if 0 < p[1] < 1]
            a.plot([p[0] for p in limit], [p[1] for p in limit],
                   color="black", linewidth=1)
            a.set_xscale("log")
            a.set_yscale("log")
            a.set_ylim(4e-6, 3e-1)
            a.grid(False)
            if i == 0:
                a.set_title(m)
            else:
                a.set_xlabel("stretch, N/m")
        axes[i][0].set_ylabel("dt, s; damping %s s" % damping)
    for word in ("stable", "refused", "unconverged", "diverged"):
        axes[0][5].scatter([], [], marker="s", color=OUTCOME[word],
                           label=word)
    axes[0][5].plot([], [], color="black", label="theory's limit")
    axes[0][5].scatter([], [], marker="x", color="black",
                       label="blows up without it, caught")
    save(figure, "stability", axes[0][5], 0.06, 8)


def drift():
    table, ulp, far = rows("drift"), rows("ulp"), rows("offset")
    if not table or not ulp or not far:
        return
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6))
    for m in COLOUR:
        for bits, line in (("32", "-"), ("64", ":")):
            mine = [r for r in table if r["integrator"] == m and
                    r["precision"] == bits]
            axes[0].plot([number(r, "step") for r in mine],
                         [number(r, "energy by the first") for r in mine],
                         color=COLOUR[m], linestyle=line, linewidth=1,
                         label=m if mine and bits == "32" else None)
    axes[0].set_title("an undamped drum for 100,000 steps")
    axes[0].set_xlabel("step")
    axes[0].set_ylabel("energy by the first step's")
    axes[0].legend(fontsize=7)
    for scene, colour in (("ball", "#c1272d"), ("two corners", "#1f5fa8")):
        mine = [r for r in ulp if r["scene"] == scene]
        step = [number(r, "step") for r in mine]
        axes[1].semilogy(step, [number(r, "rms m") for r in mine],
                         color=colour, label=scene + ": rms distance")
        axes[1].semilogy(step, [max(number(r, "mean differs m"), 1e-9)
                                for r in mine],
                         color=colour, linestyle=":", linewidth=1,
                         label=scene + ": mean height")
    axes[1].set_title("two starts one ulp of one coordinate apart")
    axes[1].set_xlabel("step of 1/60 s")
    axes[1].set_ylabel("difference, m")
    axes[1].legend(fontsize=7)
    for bits, line in (("32", "-"), ("64", ":")):
        mine = [r for r in far if r["precision"] == bits and
                number(r, "offset m") > 0]
        axes[2].loglog([number(r, "offset m") for r in mine],
                       [number(r, "rms m to the origin's") for r in mine],
                       color="#444444", linestyle=line, marker="o",
                       markersize=3, label="binary" + bits)
    axes[2].set_title("the ball away from the origin, 0.5 s")
    axes[2].set_xlabel("offset, m")
    axes[2].set_ylabel("rms distance to the run at 0, m")
    axes[2].legend(fontsize=7)
    save(figure, "drift")


def stages():
    products, solves = rows("products"), rows("solves")
    distances = rows("distances")
    if not products or not solves or not distances:
        return
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 7))
    for form, colour in (("cdf", "#b0672a"), ("compact", "#1f5fa8")):
        for bits, line in (("32", "-"), ("64", ":")):
            mine = [r for r in products if r["form"] == form and
                    r["bits"] == bits]
            axes[0][0].loglog([number(r, "side") for r in mine],
                              [number(r, "ms") for r in mine], color=colour,
                              linestyle=line, marker="o", markersize=3,
                              label="%s, %s" % (form, bits))
    axes[0][0].set(title="the matrix times a vector", ylabel="ms",
                   xlabel="particles a side")
    side = max(number(r, "side") for r in solves)
    for precond, colour in (("jacobi", "#b0672a"), ("multigrid", "#1f5fa8")):
        for bits, line in (("32", "-"), ("64", ":")):
            mine = [r for r in solves if r["precond"] == precond and
                    r["bits"] == bits and r["shape"] == "draped" and
                    number(r, "side") == side]
            axes[0][1].loglog([number(r, "true residual") for r in mine],
                              [number(r, "ms") for r in mine], color=colour,
                              linestyle=line, marker="o", markersize=3,
                              label="%s, %s" % (precond, bits))
            axes[1][0].loglog([number(r, "tolerance") for r in mine],
                              [number(r, "true residual") for r in mine],
                              color=colour, linestyle=line, marker="o",
                              markersize=3, label="%s, %s: true" %
                              (precond, bits))
            axes[1][0].loglog([number(r, "tolerance") for r in mine],
                              [number(r, "reported") for r in mine],
                              color=colour, linestyle="none", marker="x",
                              markersize=6)
    axes[0][1].set(title="a solve, draped, %d² particles" % side, ylabel="ms",
                   xlabel="true relative residual")
    axes[1][0].set(title="true residual (line), the iteration's (x)",
                   xlabel="tolerance asked for", ylabel="relative residual")
    for who, colour in (("ours", "#1f5fa8"), ("textbook", "#b0672a")):
        axes[1][1].loglog([number(r, "height by width") for r in distances],
                          [number(r, who + ": largest") for r in distances],
                          color=colour, marker="o", markersize=3, label=who +
                          (", binary64" if who == "ours" else ", binary32"))
    axes[1][1].set(title="distance to a triangle: largest error",
                   xlabel="its height by its width",
                   ylabel="relative error", ylim=(1e-17, 1e3))
    for a in axes.flat:
        a.legend(fontsize=7)
    save(figure, "stages")


def pareto(points):
    """The points for which no other point is as fast and as near."""
    return [p for p in points if not any(
        q[0] <= p[0] and q[1] <= p[1] and q[:2] != p[:2] for q in points)]


def lion():
    table = [r for r in rows("lion") if r["precond"] and
             r["integrator"] != "converged"]
    if not table:
        return
    figure, axes = plt.subplots(figsize=(6.5, 4.4))
    points = [(number(r, "seconds"), number(r, "rms m"), r) for r in table]
    front = sorted(pareto(points), key=lambda p: p[0])
    axes.loglog([p[0] for p in front], [p[1] for p in front], color="#999999",
                linewidth=4, alpha=0.5, label="front")
    for t, e, r in points:
        axes.loglog([t, t], [number(r, "least m"), number(r, "most m")],
                    color=COLOUR[r["integrator"]], linewidth=1, alpha=0.6)
        axes.loglog(t, e, marker="o" if r["precond"] == "multigrid" else "s",
                    color=COLOUR[r["integrator"]], markersize=5)
        axes.annotate("1/%d, %s%s%s" % (
            round(1 / number(r, "dt")), r["tolerance"],
            ", jacobi" if r["precond"] == "jacobi" else "",
            ", 64" if r["precision"] == "64" else ""), (t, e), fontsize=6,
            xytext=(4, 3), textcoords="offset points")
    axes.plot([], [], "o", color=COLOUR["baraff-witkin"],
              label="baraff-witkin: dt, tolerance")
    axes.plot([], [], "o", color=COLOUR["choi-ko"], label="choi-ko")
    axes.set(title="lion 20K, the first 0.3 s",
             xlabel="processor seconds, one thread",
             ylabel="rms distance to the converged run, m")
    axes.legend(fontsize=7)
    save(figure, "lion")


def backends():
    """Draws the reference on one thread and a device, with the same errors."""
    table = [r for r in rows("backends") if r["integrator"] != "converged"]
    if not table:
        return
    sides = list(dict.fromkeys(r["side"] for r in table))
    figure, axes = plt.subplots(1, len(sides), figsize=(9, 3.8), squeeze=False)
    for a, side in zip(axes[0], sides):
        for m in COLOUR:
            for backend, line in (("ref", "--"), ("gpu", "-")):
                curve(a, [r for r in table if r["side"] == side and
                          r["integrator"] == m and r["backend"] == backend and
                          r["tolerance"] in ("0", "0.001") and
                          r["precision"] == "32"],
                      "rms m", "%s, %s" % (m, backend), color=COLOUR[m],
                      linestyle=line, marker="o")
        a.set(title="hanging, %s particles a side" % side,
              xlabel="seconds for 0.1 s of one scene")
    axes[0][0].set_ylabel("rms distance to the converged run, m")
    save(figure, "backends", axes[0][0])


def settings():
    """Writes the cheapest setting for each scene and error as Markdown."""
    table = [r for r in rows("work") if r["integrator"] != "converged" and
             r["end"] == "stable" and r["rms m"]]
    if not table:
        return
    out = ["| scene | rms error up to, m | cheapest | seconds |",
           "| --- | --- | --- | --- |"]
    for scene in dict.fromkeys(r["scene"] for r in table):
        for level in (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7):
            fits = [r for r in table if r["scene"] == scene and
                    number(r, "rms m") <= level]
            if not fits:
                out.append("| %s | %g | none of these | |" % (scene, level))
                continue
            best = min(fits, key=lambda r: number(r, "seconds"))
            what = "%s, dt %.2g, binary%s" % (
                best["integrator"], number(best, "dt"), best["precision"])
            if best["precond"]:
                what += ", %s, %s" % (best["precond"], best["tolerance"])
            elif int(best["substeps"]) > 1:
                what += " in %s substeps" % best["substeps"]
            out.append("| %s | %g | %s | %s |" % (scene, level, what,
                                                  best["seconds"]))
    with open(os.path.join(HERE, "settings.md"), "w") as f:
        f.write("\n".join(out) + "\n")


for picture in (work, stability, drift, stages, lion, backends, settings):
    picture()
