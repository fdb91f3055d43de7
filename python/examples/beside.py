# SPDX-License-Identifier: Apache-2.0
"""One scene by several simulators: a sheet of 1 m falls on a ball and folds over it.
drape counts, exactly, the pairs of triangles that intersect in each frame.

usage: beside.py [drape|mujoco|mujoco-stiff|mujoco-ipc|newton [FILE.npz|FILE.png]]
FILE.npz gets the frames, which `drape audit` and `drape view` read, too; FILE.png a
picture of the last one.
"""

from __future__ import annotations

import sys
import textwrap
import time
from collections.abc import Callable, Iterator

import numpy as np

import drape

SIDE, CELLS = 1.0, 24  # m, along each side
DENSITY, STRETCH, POISSON, THICK = 0.3, 1000.0, 0.3, 2e-3  # kg/m², N/m, 1, m
SHEAR = STRETCH / (2 * (1 + POISSON))
BEND = STRETCH * 1e-6 / (12 * (1 - POISSON**2))  # of a plate 1 mm thick
FRICTION, RADIUS, HEIGHT = 0.3, 0.2, 0.25  # m: of the ball; of the sheet above it
RATE, FRAMES = 60, 45

Run = tuple[str, np.ndarray, Iterator[np.ndarray]]


def shape() -> drape.Obstacle:
    """Returns the ball."""
    return drape.Obstacle(shape="sphere", radius=RADIUS, friction=FRICTION, detail=48)


def fall() -> drape.World:
    """Returns a world with the sheet over the ball."""
    cloth = drape.Cloth(
        particles=[CELLS + 1, CELLS + 1],
        size=[SIDE, SIDE],
        start=drape.Start(at=[0, HEIGHT, 0]),
        material=drape.Material(
            density=DENSITY,
            stretch=STRETCH,
            shear=SHEAR,
            bend=BEND,
            thickness=THICK,
            friction=FRICTION,
        ),
    )
    scene = drape.Scene(cloths=[cloth], obstacles=[shape()], dt=1 / RATE, precision=64)
    return drape.World(scene)


def by_drape() -> Run:
    """drape, a step a frame."""
    world = fall()
    body = world.bodies[0]

    def frames() -> Iterator[np.ndarray]:
        for frame in range(FRAMES + 1):
            if frame:
                world.step()
            yield world.positions[body.vertices].copy()

    return f"drape {drape.__version__}", world.triangles[body.triangles], frames()


def by_mujoco(kind: str = "") -> Run:
    """MuJoCo's flex with the integrator, solver and step that its manual advises
    (Modeling, Deformables); "stiff": with stiffer contacts than by default; "ipc": in
    its mode of contact without intersections."""
    import mujoco

    flag = '<flag ipc="enable"/>' if kind == "ipc" else ""
    time_constant = 0.004 if kind == "stiff" else 0.02  # s, of contacts
    cell, steps = SIDE / CELLS, 8
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco>
        <option timestep="{1 / RATE / steps}" integrator="discrete" solver="Newton"
                tolerance="1e-6">{flag}</option>
        <size memory="1G"/>
        <worldbody>
          <geom type="sphere" size="{RADIUS}" friction="{FRICTION}"/>
          <flexcomp name="cloth" type="grid" count="{CELLS + 1} {CELLS + 1} 1"
                    spacing="{cell} {cell} 1" pos="0 0 {HEIGHT}" dim="2"
                    radius="{THICK / 2}" mass="{DENSITY * SIDE**2}">
            <contact selfcollide="auto" friction="{FRICTION}"
                     solref="{time_constant} 1"/>
            <elasticity young="{STRETCH / 1e-3}" poisson="{POISSON}" thickness="1e-3"
                        damping="0.005" elastic2d="both"/>
          </flexcomp>
        </worldbody>
        </mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)

    def frames() -> Iterator[np.ndarray]:
        for frame in range(FRAMES + 1):
            for _ in range(steps if frame else 0):
                mujoco.mj_step(model, data)
            yield y_up(data.flexvert_xpos)

    name = f"MuJoCo {mujoco.__version__}{kind and ', '}{kind}"
    return name, model.flex_elem.reshape(-1, 3).copy(), frames()


def by_newton() -> Run:
    """Newton's VBD with self-contact, with the iterations and substeps of its own
    example of hanging cloth."""
    import newton
    import warp

    warp.config.quiet = True
    warp.set_device("cpu")
    builder, cell, steps = newton.ModelBuilder(), SIDE / CELLS, 10
    config = builder.default_shape_cfg.copy()
    config.mu = FRICTION
    builder.add_shape_sphere(body=-1, radius=RADIUS, cfg=config)
    builder.add_cloth_grid(
        pos=warp.vec3(-SIDE / 2, -SIDE / 2, HEIGHT),
        rot=warp.quat_identity(),
        vel=warp.vec3(0.0, 0.0, 0.0),
        dim_x=CELLS,
        dim_y=CELLS,
        cell_x=cell,
        cell_y=cell,
        mass=DENSITY * SIDE**2 / (CELLS + 1) ** 2,
        tri_ke=STRETCH,
        tri_ka=STRETCH,
        tri_kd=1e-3,
        edge_ke=BEND,
        edge_kd=1e-3,
        particle_radius=THICK,
    )
    builder.color(include_bending=True)
    model = builder.finalize()
    model.soft_contact_ke, model.soft_contact_kd = 1e3, 1e-1
    model.soft_contact_mu = FRICTION
    solver = newton.solvers.SolverVBD(
        model,
        iterations=10,
        particle_enable_self_contact=True,
        particle_self_contact_margin=THICK,
        particle_self_contact_gap=0.75 * THICK,
        particle_vertex_contact_buffer_size=64,
        particle_edge_contact_buffer_size=128,
    )
    pipeline = newton.CollisionPipeline(model)
    now, then, contacts = model.state(), model.state(), pipeline.contacts()

    def frames() -> Iterator[np.ndarray]:
        nonlocal now, then
        for frame in range(FRAMES + 1):
            for _ in range(steps if frame else 0):
                now.clear_forces()
                pipeline.collide(now, contacts)
                solver.step(now, then, model.control(), contacts, 1 / RATE / steps)
                now, then = then, now
            yield y_up(now.particle_q.numpy())

    triangles = model.tri_indices.numpy().reshape(-1, 3)
    return f"Newton {newton.__version__}, VBD", triangles, frames()


def picture(x: np.ndarray, file: str) -> None:
    """Makes a picture of the last of some frames."""
    side = CELLS + 1
    rows = x.reshape(-1, side, side, 3)
    u, v = rows[0, 0, 1] - rows[0, 0, 0], rows[0, 1, 0] - rows[0, 0, 0]
    if np.cross(u, v)[1] > 0:  # the sheet's other side is up
        rows = rows.swapaxes(1, 2)
    cloth = drape.Cloth(
        particles=[side, side],
        size=[SIDE, SIDE],
        positions=rows[-1].reshape(-1, 3),
    )
    camera = drape.Camera(eye=[1.0, 0.5, 1.2], target=[0, -0.1, 0])
    scene = drape.Scene(
        cloths=[cloth], obstacles=[shape()], camera=camera, allow_intersecting=True
    )
    drape.World(scene).render(file, width=400, height=360, samples=32)


def y_up(x: np.ndarray) -> np.ndarray:
    """Returns positions with +z up as positions with +y up."""
    return np.stack([x[:, 0], x[:, 2], -x[:, 1]], 1).astype(np.float64)


BY: dict[str, Callable[[], Run]] = {
    "drape": by_drape,
    "mujoco": by_mujoco,
    "mujoco-stiff": lambda: by_mujoco("stiff"),
    "mujoco-ipc": lambda: by_mujoco("ipc"),
    "newton": by_newton,
}


def main(by: str = "drape", file: str | None = None) -> list[int]:
    """Runs the scene and prints the counts of each frame; returns those of the cloth
    with itself."""
    name, faces, frames = BY[by]()
    began = time.process_time()
    x = np.array(list(frames))
    seconds = time.process_time() - began
    own = [each.pairs for each in drape.audit_frames(x, faces)]
    # the ball's mesh lies within the ball: what intersects it is in the ball
    world = fall()
    body = world.bodies[1]
    around = world.positions[body.vertices]
    inside = world.triangles[body.triangles] - body.vertices.start
    both = np.concatenate([x, np.broadcast_to(around, (len(x), *around.shape))], axis=1)
    tri = np.concatenate([faces, inside + x.shape[1]])
    group = np.repeat([1, 0], [len(faces), len(inside)])
    all_ = [each.pairs for each in drape.audit_frames(both, tri, group)]
    bad = sum(count > 0 for count in all_)
    corners = x[:, faces]  # and the middles of their edges, and of their triangles
    middles = (corners + np.roll(corners, 1, axis=2)) / 2, corners.mean(axis=2)
    points = np.concatenate([each.reshape(-1, 3) for each in (x, *middles)])
    deep = 1e3 * max(RADIUS - np.linalg.norm(points, axis=1).min(), 0)
    print(f"{name}: {len(x)} frames, {bad} with intersecting pairs")
    low = -x[-1, :, 1].min()
    print(f"at most {deep:.1f} mm in the ball; hangs {low:.2f} m down at the end")
    for words, counts in (
        ("cloth and cloth:", own),
        ("cloth and ball:", [a - b for a, b in zip(all_, own, strict=True)]),
    ):
        text = " ".join([words, *map(str, counts)])
        print(textwrap.fill(text, 80, subsequent_indent="  "))
    print(f"{name}: {seconds:.1f} s of a core", file=sys.stderr)
    if file and file.endswith(".png"):
        picture(x, file)
    elif file:
        np.savez_compressed(file, frames=x, faces=faces, frame_dt=1 / RATE)
    return own


if __name__ == "__main__":
    if len(sys.argv) > 3 or not {*sys.argv[1:2]} <= BY.keys():
        sys.exit((__doc__ or "").strip())
    main(*sys.argv[1:])
