# SPDX-License-Identifier: Apache-2.0
"""Whether pictures have the colours that their scenes say.

usage: png.py PLAIN BLUE FLOOR DIM EAST WEST    PNG files of the tool: the plain
        scene has a red cloth, the others a blue cloth, a green floor, and less
        light; EAST and WEST have a ball in the middle and a low sun on that side
Fails with a line that names the picture.
"""
import struct
import sys
import zlib


def read(path):
    """The rows of a picture, each with three bytes a pixel."""
    with open(path, "rb") as file:
        data = file.read()
    width, height, at, packed = *struct.unpack(">II", data[16:24]), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        check = struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0]
        assert check == zlib.crc32(data[at + 4:at + 8 + size]), kind
        at += size + 12
    assert kind == b"IEND" and at == len(data), "its end"
    raw, rows, before = zlib.decompress(packed), [], bytearray(3 * width)
    for row in range(height):
        line = raw[row * (3 * width + 1):(row + 1) * (3 * width + 1)]
        before = unfilter(line[0], bytearray(line[1:]), before)
        rows.append(before)
    return rows


def mean(path):
    """The mean of red, green and blue over the whole picture."""
    rows = read(path)
    return [sum(sum(row[k::3]) for row in rows) / (len(rows) * len(rows[0]) / 3)
            for k in range(3)]


def swell(path, limb, middle):
    """How much brighter, a byte, a ball in the middle is in three columns near
    its limb than in three near its middle: it is if its light follows its shape.
    """
    rows = read(path)[22:26]
    return sum(sum(row[3 * limb:3 * limb + 9]) - sum(row[3 * middle:3 * middle + 9])
               for row in rows) / (9 * len(rows))


def unfilter(kind, line, above):
    """A row of pixels from its filtered bytes (PNG, RFC 2083 §6)."""
    for k, byte in enumerate(line):
        left = line[k - 3] if k > 2 else 0
        up, corner = above[k], above[k - 3] if k > 2 else 0
        guess = left + up - corner
        paeth = min((left, up, corner), key=lambda v: abs(guess - v))
        line[k] = (byte + (0, left, up, (left + up) // 2, paeth)[kind]) & 255
    return line


def main():
    plain, blue, floor, dim = map(mean, sys.argv[1:5])
    east, west = swell(sys.argv[5], 36, 32), swell(sys.argv[6], 25, 29)
    for name, good in (("plain: red", plain[0] > plain[2] + 5),
                       ("blue", blue[2] > blue[0] + 5),
                       ("floor: green", floor[1] > floor[0] + 5),
                       ("dim", sum(dim) < sum(plain) - 15),
                       ("a low sun in the east", east > 20),
                       ("a low sun in the west", west > 20)):
        if not good:
            sys.exit(f"{name}: {plain} {blue} {floor} {dim} {east} {west}")


if __name__ == "__main__":
    main()
