# SPDX-License-Identifier: Apache-2.0
"""The plots of bench/tables.py as SVG, of its csv files alone."""
import csv
import math
import os

WIDTH, HEIGHT = 860, 380
LEFT, RIGHT, TOP, BOTTOM = 70, 150, 40, 70
COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00",
           "#999999"]


class Plot:
    """A picture whose axes span the unit square; y points up."""

    def __init__(self, title, unit):
        self.lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" '
            f'height="{HEIGHT}" font-family="sans-serif" font-size="12">',
            f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
        self.text(LEFT, 20, f"{title}, {unit}", "start", 14)

    def text(self, x, y, words, anchor="middle", size=12):
        self.lines.append(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" '
                          f'text-anchor="{anchor}">{words}</text>')

    def place(self, x, y):
        return (LEFT + x * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - y * (HEIGHT - TOP - BOTTOM))

    def box(self, x0, x1, y0, y1, colour):
        left, bottom = self.place(x0, max(0, y0))
        right, top = self.place(x1, y1)
        self.lines.append(
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
            f'height="{max(0, bottom - top):.1f}" fill="{colour}"/>')

    def tick(self, y, words):
        left, at = self.place(0, y)
        right, _ = self.place(1, y)
        self.lines.append(f'<path d="M{left} {at:.1f}H{right}" '
                          f'stroke="#dddddd"/>')
        self.text(left - 6, at + 4, words, "end")

    def below(self, x, words):
        left, at = self.place(x, 0)
        for k, word in enumerate(words.split("_")):
            self.text(left, at + 16 + 14 * k, word)

    def legend(self, names):
        for k, name in enumerate(names):
            y = TOP + 18 * k
            self.lines.append(f'<rect x="{WIDTH - RIGHT + 12}" y="{y}" '
                              f'width="12" height="12" '
                              f'fill="{COLOURS[k % 7]}"/>')
            self.text(WIDTH - RIGHT + 30, y + 11, name, "start")

    def save(self, path):
        with open(path, "w") as file:
            file.write("\n".join(self.lines + ["</svg>"]) + "\n")


def number(text):
    return float(text) if text else 0.0


def read(folder, name):
    with open(os.path.join(folder, name + ".csv")) as file:
        header, *rows = csv.reader(file)
    return header, rows


def bars(title, unit, groups, names):
    """Bars side by side on a logarithmic scale. groups: (name, values)."""
    plot = Plot(title, unit)
    values = [v for _, group in groups for v in group if v > 0]
    lo = math.floor(math.log10(min(values)))
    hi = max(lo + 1, math.ceil(math.log10(max(values))))
    for k in range(lo, hi + 1):
        plot.tick((k - lo) / (hi - lo), f"{10.0 ** k:g}")
    for i, (name, group) in enumerate(groups):
        for k, value in enumerate(group):
            x0 = (i + 0.1 + 0.8 * k / len(names)) / len(groups)
            x1 = x0 + 0.75 / len(names) / len(groups)
            if value > 0:
                y = (math.log10(value) - lo) / (hi - lo)
                plot.box(x0, x1, 0, y, COLOURS[k])
        plot.below((i + 0.5) / len(groups), name)
    plot.legend(names)
    return plot


def stacks(title, unit, columns, names, labels):
    """Stacked bars. columns: lists of values; labels: {column: text}."""
    plot = Plot(title, unit)
    most = max(sum(column) for column in columns)
    step = 10.0 ** math.floor(math.log10(most))
    step = step if most / step > 2.5 else step / 4
    for k in range(int(most / step) + 1):
        plot.tick(k * step / most, f"{k * step:g}")
    gap = 0.1 if len(columns) < 20 else 0
    for i, column in enumerate(columns):
        y = 0
        for k, value in enumerate(column):
            plot.box((i + gap) / len(columns), (i + 1 - gap) / len(columns),
                     y / most, (y + value) / most, COLOURS[k])
            y += value
    for i, words in labels.items():
        plot.below((i + 0.5) / len(columns), words)
    plot.legend(names)
    return plot


def columns_of(header, rows, wanted):
    """(name, values) for each row. A column is the last one of its name."""
    at = [len(header) - 1 - header[::-1].index(name) for name in wanted]
    return [(row[0], [number(row[k]) for k in at]) for row in rows]


def figure8(header, rows):
    wanted = ["s a frame, mean", "K20c", "GTX 680", "paper: GTX 580"]
    return bars("Figure 8", "seconds a frame",
                columns_of(header, rows, wanted),
                ["here", "paper, K20c", "paper, GTX 680", "paper, GTX 580"])


def figure9(header, rows):
    paper = ["paper: explicit GB", "implicit GB"]
    groups = columns_of(header, rows, ["explicit MB", "implicit MB"] + paper)
    groups = [(name, v[:2] + [1e3 * v[2], 1e3 * v[3]]) for name, v in groups]
    return bars("Figure 9", "memory, MB", groups,
                ["here, explicit", "here, implicit", "paper, explicit",
                 "paper, implicit"])


def figure10(header, rows):
    """As in the paper, the buddha in all sizes."""
    rows = [row for row in rows if row[0].startswith("buddha")] or rows
    columns = [[number(v) for v in row[2:]] for row in rows]
    shares = [[100 * v / (sum(c) or 1) for v in c] for c in columns]
    labels = {k: f"{row[0]}_{row[1]}" for k, row in enumerate(rows)}
    names = [name.removesuffix(" MB") for name in header[2:]]
    return stacks("Figure 10", "memory by part, %", shares, names, labels)


def figure11(header, rows):
    """As in the paper, the largest buddha; without one, the last scene."""
    scenes = list(dict.fromkeys(row[0] for row in rows))
    buddhas = [scene for scene in scenes if scene.startswith("buddha")]
    scene = (buddhas or scenes)[-1]
    mine = [row for row in rows if row[0] == scene]
    columns = [[number(v) for v in row[2:]] for row in mine]
    labels = {k: row[1] for k, row in enumerate(mine)
              if (k + 1) % max(1, len(mine) // 6) == 0}
    names = [name.removesuffix(" s") for name in header[2:]]
    return stacks("Figure 11", f"{scene}: seconds a frame, by frame", columns,
                  names, labels)


def figure12(header, rows):
    groups = {}
    for row in rows:
        values = dict(zip(header, row))
        group = groups.setdefault(row[0], {})
        group[values["threads"]] = number(values["speed-up"])
        for name in ("paper: K20c", "GTX 680"):
            group[name] = max(group.get(name, 0), number(values[name]))
    threads = sorted({row[header.index("threads")] for row in rows}, key=int)
    keys = threads + ["paper: K20c", "GTX 680"]
    return bars("Figure 12", "speed-up over the processor",
                [(name, [group.get(k, 0) for k in keys])
                 for name, group in groups.items()],
                [f"here, threads: {k}" for k in threads] +
                ["paper, K20c", "paper, GTX 680"])


FIGURES = {"figure8": figure8, "figure9": figure9, "figure10": figure10,
           "figure11": figure11, "figure12": figure12}


def draw(folder, name):
    """Draws folder/name.svg from folder/name.csv. False if it has no plot."""
    if name not in FIGURES:
        return False
    plot = FIGURES[name](*read(folder, name))
    plot.save(os.path.join(folder, name + ".svg"))
    return True
