#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The digest of what is compiled of a folder: comments, white space and pages
are not in it.

usage: ci/tree.py spec | ref | gpu | flags    flags: those of the Makefile that
                                              decide what kernels compute

Sources are split into the tokens of the language (C17 §5.1.1.2: continued lines
are joined first, a comment is one space), so that a comment, a line break or an
indentation does not show. A directive ends where its line does.
"""
import hashlib
import os
import re
import sys

SOURCES = (".c", ".h", ".cu", ".cuh", ".cpp", ".def")
TOKEN = re.compile(r"""
    (?P<space> /\*.*?\*/ | //[^\n]* | [^\S\n]+ )
  | (?P<end> \n )
  | (?P<text> "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*' )
  | (?P<word> [\w.]+(?:(?<=[eEpP])[+-][\w.]+)* )
  | (?P<mark> <<<|>>>|<<=|>>=|->|\+\+|--|<<|>>|[<>=!+*/%&|^-]=|&&|\|\||\#\#|::|.)
    """, re.X | re.S)


def code(text):
    """The tokens of a source, a space between two; each directive on a line."""
    out, directive, fresh = [], False, True
    for found in TOKEN.finditer(text.replace("\\\n", "")):
        kind, token = found.lastgroup, found.group()
        if kind == "end":
            out += ["\n"] if directive else []
            directive, fresh = False, True
        elif kind != "space":
            if fresh and token == "#":
                directive = True
                out.append("\n")
            fresh = False
            out.append(token)
    return " ".join(out)


def flags(makefile):
    """The lines of the variables that decide what kernels compute."""
    on, kept = False, []
    for line in makefile:
        on = on or line.startswith(("MODEL", "CUDA"))
        if on:
            kept.append(" ".join(line.split()))
        on = on and line.endswith("\\\n")
    return "\n".join(kept)


def digest(part):
    sha = hashlib.sha256()
    if part == "flags":
        with open("Makefile") as file:
            sha.update(flags(file).encode())
        return sha.hexdigest()[:40]
    for name in sorted(os.path.join(at, name)
                       for at, _, names in os.walk(part) for name in names):
        if name.endswith(SOURCES):
            with open(name, encoding="utf-8") as file:
                sha.update(f"{name}\n{code(file.read())}\n\n".encode())
    return sha.hexdigest()[:40]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(digest(sys.argv[1]))
