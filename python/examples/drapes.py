# SPDX-License-Identifier: Apache-2.0
"""A data set of 64 drapes: sheets of random fabrics over a ball of random size and
place, as one array for learning. Number k is the same on every machine.

usage: drapes.py [FOLDER]: results are kept there, and not computed again
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import drape

COUNT, SEED = 64, 1

scene = drape.Scene(
    cloths=[drape.Cloth(particles=[17, 17], start=drape.Start(at=[0, 0.8, 0]))],
    obstacles=[drape.Obstacle(shape="sphere", radius=0.3, at=[0, 0.4, 0], detail=24)],
    frames=30,
)
axes = {
    "cloths.0.material.name": ["cotton", "denim", "silk", "wool"],
    "cloths.0.material.friction": (0.1, 0.6),
    "obstacles.0.radius": (0.2, 0.35),
    "obstacles.0.at": lambda random: [random.uniform(-0.1, 0.1), 0.4, 0],
}


def main(folder: str) -> np.ndarray:
    """Writes FOLDER/drapes.npz and returns its positions [count, particles, 3], m."""
    done = drape.sweep(drape.sample(scene, axes, COUNT, SEED), folder)
    assert not done.failed and all(row["clean"] for row in done.rows)
    data = [done.data(k) for k in range(COUNT)]
    first, last = data[0]["body_vertices"][0]
    x = np.stack([each["positions"][first:last] for each in data])
    labels = np.array([row["label"] for row in done.rows])
    rest = data[0]["rest"][first:last]
    file = Path(folder) / "drapes.npz"
    np.savez_compressed(file, positions=x, labels=labels, rest=rest)
    print(f"{file.name}: {x.shape}, {done.reused} were there already")
    print(f"the first: {labels[0]}")
    print(f"they hang {x[:, :, 1].min(axis=1).mean():.3f} m high in the mean")
    return x


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1])
    else:
        with tempfile.TemporaryDirectory() as here:
            main(here)
