# SPDX-License-Identifier: Apache-2.0
"""Pictures of tables, by matplotlib: what bench/accuracy and validate
share. A page is a folder of csv files, in which its pictures appear."""
import csv
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9",
           "#999999", "#000000"]
plt.rcParams.update({"axes.grid": True, "grid.alpha": 0.25,
                     "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "savefig.dpi": 110})


class Page:
    """A folder of tables and pictures; size: of the letters, points."""

    def __init__(self, folder, size):
        self.folder = folder
        plt.rcParams["font.size"] = size

    def rows(self, name):
        """The rows of a table; none where there is no file of it."""
        path = os.path.join(self.folder, name + ".csv")
        if not os.path.exists(path):
            return []
        with open(path, newline="") as file:
            return list(csv.DictReader(file))

    def save(self, figure, name, legend=None, below=0.1, size=7):
        """Saves a figure, with the legend of some axes below all axes."""
        if legend:
            figure.legend(*legend.get_legend_handles_labels(), ncol=6,
                          loc="lower center", fontsize=size)
        figure.tight_layout(rect=(0, below if legend else 0, 1, 1))
        figure.savefig(os.path.join(self.folder, name + ".png"))
        plt.close(figure)


def number(row, key):
    return float(row[key]) if row[key] else float("nan")
