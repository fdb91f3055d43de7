#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The corpora of the fuzz targets: fuzz/corpus/TARGET.tar, a file an input. `make
corpus` unpacks them into BUILD/corpus.

usage: fuzz/corpus.py add TARGET FILE...    adds inputs under their names, but for
                                            those that the archive holds already
       fuzz/corpus.py pack TARGET FOLDER    an archive of this folder's files alone
       fuzz/corpus.py list                  how many inputs each archive has

The bytes of an archive follow from the names and the bytes of its inputs alone, so
that git sees a change only where there is one.
"""
import io
import os
import sys
import tarfile

CORPORA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "corpus")


def read(path):
    """The inputs of an archive, name to bytes; none where there is no archive."""
    if not os.path.exists(path):
        return {}
    with tarfile.open(path, "r:") as archive:
        return {each.name: archive.extractfile(each).read() for each in archive}


def write(path, inputs):
    """Replaces an archive by a whole one of these inputs."""
    with tarfile.open(path + ".part", "w", format=tarfile.USTAR_FORMAT) as archive:
        for name in sorted(inputs):
            head = tarfile.TarInfo(name)  # of mode 644, time 0 and nobody
            head.size = len(inputs[name])
            archive.addfile(head, io.BytesIO(inputs[name]))
    os.replace(path + ".part", path)


def files(paths):
    """Name to bytes of files."""
    inputs = {}
    for path in paths:
        with open(path, "rb") as file:
            inputs[os.path.basename(path)] = file.read()
    return inputs


def add(path, new):
    """Adds inputs to an archive. Returns how many; a name that stands for other
    bytes there ends the program."""
    inputs = read(path)
    known, count = set(inputs.values()), len(inputs)
    for name, data in new.items():
        if data not in known:
            if name in inputs:
                sys.exit(f"{path}: another input has the name {name}")
            inputs[name] = data
            known.add(data)
    write(path, inputs)
    return len(inputs) - count


def main(what="", target="", *paths):
    path = os.path.join(CORPORA, f"{target}.tar")
    if what == "list" and not target:
        names = sorted(n for n in os.listdir(CORPORA) if n.endswith(".tar"))
        counts = [len(read(os.path.join(CORPORA, name))) for name in names]
        for name, count in zip(names, counts):
            print(f"{count:5} {name[:-len('.tar')]}")
        print(f"{sum(counts):5} inputs of {len(names)} targets")
    elif what == "add" and paths:
        print(f"{path}: {add(path, files(paths))} inputs more")
    elif what == "pack" and len(paths) == 1:
        inputs = files(os.path.join(paths[0], n) for n in os.listdir(paths[0]))
        write(path, inputs)
        print(f"{path}: {len(inputs)} inputs")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(*sys.argv[1:])
