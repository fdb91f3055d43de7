# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of spec/validation.md anew from the csv of build/validate.
usage: page.py DIRECTORY PAGE

A table stands between `<!-- table PART -->` and `<!-- end -->`. The part `missed`
is of all rows that miss their bars."""
import csv
import os
import re
import sys


def rows(folder, part):
    path = os.path.join(folder, f"properties-{part}.csv")
    if not os.path.exists(path):
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def short(text, digits=4):
    return f"{float(text):.{digits}g}" if text else ""


def error_of(row):
    """The error in the unit of its bar: a share of theory in %, or itself."""
    if not row["error"]:
        return "no rest" if row["result"] == "MISSED" else ""
    return short(row["error"], 2)


def sizes(row):
    """Values by size, the coarsest first."""
    found = []
    for k in range(1, 5):
        if row[f"size {k}"]:
            value = short(row[f"value {k}"]) or "no rest"
            found.append(f"{value} ({1e3 * float(row[f'size {k}']):.3g})")
    return " · ".join(found)


def order_of(row):
    """Of the errors over the sizes; none where they do not depend on them."""
    value = float(row["order"]) if row["order"] else 0
    exact = not row["theory"] or (row["error"] and float(row["error"]) < 1e-5)
    return "–" if exact or abs(value) < 0.2 else f"{value:.1f}"


def verdict(row):
    if row["result"] == "MISSED":
        return "**FAILS**" if row["promised"] == "yes" else "**fails**, known"
    return {"met": "meets", "shown": "no bar"}[row["result"]]


def missed(folder):
    """Every row of any part that misses its bar."""
    lines = []
    for name in sorted(os.listdir(folder)):
        part = re.fullmatch(r"properties-(\w+)\.csv", name)
        for row in rows(folder, part[1]) if part else []:
            if row["result"] == "MISSED":
                lines.append(f"| {part[1]} | {row['property'].replace(';', ',')}"
                             f" | {row['bits']} | {error_of(row)} | "
                             f"{short(row['bar'])} | {verdict(row)} |")
    head = ["| part | property | bits | error | bar | |",
            "| --- | --- | --- | --- | --- | --- |"]
    return "\n".join(head + lines) if lines else "None."


def table(folder, part):
    if part == "missed":
        return missed(folder)
    lines = ["| property | bits | theory | value (size, mm or ms) | error | "
             "order | bar | |", "| --- | --- | --- | --- | --- | --- | --- | "
             "--- |"]
    for row in rows(folder, part):
        name = row["property"].replace(";", ",")
        unit = "" if row["unit"] == "1" else f", {row['unit']}"
        lines.append(
            f"| {name}{unit} | {row['bits']} | {short(row['theory'])} | "
            f"{sizes(row)} | {error_of(row)} | {order_of(row)} | "
            f"{short(row['bar'])} | {verdict(row)} |")
    if len(lines) == 2:
        return "Not run."
    return "\n".join(lines)


def main(folder, page):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    text = re.sub(r"<!-- table (\w+) -->.*?<!-- end -->", lambda found:
                  f"<!-- table {found[1]} -->\n{table(folder, found[1])}\n"
                  "<!-- end -->", text, flags=re.S)
    with open(page, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
