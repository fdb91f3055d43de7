# SPDX-License-Identifier: Apache-2.0
"""The invariant of the collision response, spec/contact/response.md §7, on all small
scenes: builds ci/models/response.c, which includes the code of ref/, and runs it; then
with faults planted in that code, each of which it must find."""
import os
import re
import subprocess

# What is wrong, in which file of ref/contact, what it replaces and by what.
FAULTS = (
    ("the vertices of impacts are not touched", "rounds",
     "s->touched[hit[k]] = s->w[hit[k]] > 0", "s->touched[hit[k]] = 0"),
    ("a vertex that moved is not touched", "rounds",
     "        s->touched[i] = 1;\n", ""),
    ("a vertex that is rolled back is not touched", "rollback",
     "            s->touched[i] |= can_go(s, i);", "            s->touched[i] = 0;"),
    ("not all vertices go back in the end", "rollback",
     "s->touched[i] |= all && can_go(s, i)", "s->touched[i] |= 0 && all"),
    ("a prescribed vertex goes back", "rollback",
     "return s->w[i] > 0 && !s->rolled[i]", "return !s->rolled[i]"),
    ("a vertex goes back again and again", "rollback",
     "return s->w[i] > 0 && !s->rolled[i]", "return s->w[i] > 0"),
    ("a vertex that goes back keeps its end", "rollback",
     "        s->x1[i] = s->x0[i];\n", ""),
    ("no pair is trapped", "rollback", "s->trapped += !any", "s->trapped += 0"),
    ("rollback ends after a round", "failsafe", "s->hits = r.grown", "s->hits = 0"),
    ("trapped is not told", "failsafe",
     "    if (r.trapped)\n        s->outcome |= DRAPE_TRAPPED;\n", ""),
    ("zones go on for a round", "response", "if (rolls >= 0)", "if (rolls > 0)"),
    ("a pair that started so is not told", "response",
     "if (s->started || s->prescribed)", "if (s->prescribed)"),
    ("a prescribed pair is not told", "response",
     "if (s->started || s->prescribed)", "if (s->started)"),
    ("later detections forget what the first left out", "response",
     "    if (!touched) {\n        s->started", "    {\n        s->started"),
    ("the last impact is lost", "response", "    s->hits = m.found;", "    s->hits = "
     "m.found > 1 ? m.found - 1 : m.found;"),
    ("a pair counts as prescribed by its last vertex", "impacts",
     "any_free |= s->w", "any_free = s->w"),
    ("rounds end when impulses do", "response",
     "if (s->stop_before_zones && round", "if (round"),
)
FILES = ("failsafe", "impacts", "response", "rollback", "rounds")
FLAGS = ("-std=c17 -D_POSIX_C_SOURCE=200809L -O2 -ffp-contract=off -Wall -Wextra "
         "-Wno-unknown-pragmas -Wno-unused").split()


def sources():
    """The files of ref/contact that a fault may be planted in."""
    found = {}
    for name in FILES:
        with open(f"ref/contact/{name}.c", encoding="utf-8") as file:
            found[name] = file.read()
    return found


def build(folder, build_folder, texts):
    """Compiles the program with these files of ref/contact. Returns what failed."""
    os.makedirs(f"{folder}/ref/contact", exist_ok=True)
    for name, text in texts.items():
        with open(f"{folder}/ref/contact/{name}.c", "w", encoding="utf-8") as file:
            file.write(text)
    made = subprocess.run(["gcc", *FLAGS, f"-I{folder}", "-I.", "-Ispec",
                           f"-I{build_folder}", "-o", f"{folder}/response",
                           "ci/models/response.c", "-lm"],
                          capture_output=True, text=True, check=False)
    return made.stderr[-2000:] if made.returncode else ""


def run(folder, vertices, pairs, parts=1):
    """Runs the program in parts: whether it found no fault, and what it says."""
    started = [subprocess.Popen([f"{folder}/response", str(vertices), str(pairs), str(k),
                                 str(parts)], stdout=subprocess.PIPE, text=True)
               for k in range(parts)]
    said = [process.communicate()[0].strip() for process in started]
    for process, text in zip(started, said):
        if process.returncode:
            return False, text or f"FAILED response: status {process.returncode}"
    counts = [[int(word) for word in re.findall(r"\d+", text)] for text in said]
    return True, (f"{counts[0][0]} scenes, {sum(c[1] for c in counts)} states, "
                  f"{sum(c[2] for c in counts)} runs")


def check(build_folder, quick):
    """[(passed, line)]."""
    folder, texts = f"{build_folder}/models/response", sources()
    made = subprocess.run(["make", "-s", f"BUILD={build_folder}",
                           f"{build_folder}/names/ref.h"], capture_output=True, text=True,
                          check=False)
    why = made.stderr if made.returncode else build(folder, build_folder, texts)
    if why:
        return [(False, f"FAILED response: {why}")]
    size = (5, 3) if quick else (6, 4)
    good, said = run(folder, *size, os.cpu_count() or 1)
    results = [(good, f"proved response, up to {size[0]} vertices and {size[1]} pairs: "
                f"{said}" if good else said)]
    for k, (fault, name, old, new) in enumerate(FAULTS[:3] if quick else FAULTS):
        if texts[name].count(old) != 1:
            results.append((False, f"FAILED response, {fault}: no place in {name}.c"))
            continue
        why = build(f"{folder}/{k}", build_folder,
                    {**texts, name: texts[name].replace(old, new)})
        good, said = (True, why) if why else run(f"{folder}/{k}", 5, 3)
        results.append((not good, f"FAILED response, {fault}: not found: {said}" if good
                        else f"ok response, {fault}: found: {said[7:90]}"))
    return results
