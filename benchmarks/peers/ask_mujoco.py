"""Adapter for MuJoCo: simulate, and test whether a part moved.

The settings reduce slip as its documentation recommends (*Modeling*, solver parameters): elliptic
cones, a large `impratio`, Newton with a small tolerance, the Noslip solver, and contacts as stiff
as two steps allow. The scene is scaled so that parts have sizes and masses of about 1. A part that
moves by more than `MOVED` of its size within `SECONDS` falls; the simulation then stops early.
"""

from __future__ import annotations

from collections.abc import Callable
from xml.sax.saxutils import quoteattr

import numpy as np
from question import Question

STEP = 0.002
"""Time step [s]."""
SECONDS = 10.0
"""Simulated time [s]."""
MOVED = 0.05
"""Displacement at which a part counts as moved [size of the part]."""
LOOKS = 100
"""Steps between two tests for displacements."""
OPTION = f"""<option timestep="{STEP}" cone="elliptic" impratio="100" solver="Newton"
 iterations="100" tolerance="1e-10" noslip_iterations="20" gravity="{{gravity}}"/>"""


def model_of(question: Question) -> str:
    """The assembly as MJCF: convex parts, with a free joint for each free part."""
    geometry, assembly = question.assembly.geometry, question.assembly
    length, weight = question.length, question.weight
    mu, condim = (assembly.friction, 3) if assembly.friction > 0 else (1.0, 1)
    meshes, bodies = [], []
    for k, name in enumerate(assembly.names):
        rows = slice(*geometry.vertex_start[k : k + 2])
        center = geometry.center[k] / length
        corners = geometry.vertices[rows] / length - center
        shape = f'friction="{mu} 0 0" condim="{condim}" solref="{2 * STEP} 1"'
        if geometry.is_box[k]:
            edges = corners[[1, 2, 4]] - corners[0]
            sizes = np.linalg.norm(edges, axis=1) / 2
            axes = numbers((edges[:2] / (2 * sizes[:2, None])).ravel())
            middle = numbers(corners.mean(axis=0))
            shape += f' type="box" size="{numbers(sizes)}" pos="{middle}" xyaxes="{axes}"'
        else:
            meshes.append(f'<mesh name="m{k}" vertex="{numbers(corners.ravel())}"/>')
            shape += f' type="mesh" mesh="m{k}"'
        inside = f"<geom {shape}/>"
        if not geometry.grounded[k]:
            moments = geometry.inertia[k] / (weight * length**2)
            six = numbers(moments[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])
            mass = geometry.mass[k] / weight
            inside += f'<freejoint/><inertial pos="0 0 0" mass="{mass:.17g}" fullinertia="{six}"/>'
        bodies.append(f'<body name={quoteattr(name)} pos="{numbers(center)}">{inside}</body>')
    option = OPTION.format(gravity=numbers(assembly.gravity))
    return (
        f'<mujoco>{option}<size memory="1G"/><asset>{"".join(meshes)}</asset>'
        f"<worldbody>{''.join(bodies)}</worldbody></mujoco>"
    )


def numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def settle(question: Question) -> Callable[[], tuple[str, str]]:
    """Simulate until a part has moved, or the time is over."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(model_of(question))
    geometry = question.assembly.geometry
    free = np.flatnonzero(~geometry.grounded)
    size = geometry.size[free] / question.length

    def run() -> tuple[str, str]:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        bodies = free + 1
        place, frame = data.xpos[bodies].copy(), data.xmat[bodies].copy()
        while data.time < SECONDS:
            mujoco.mj_step(model, data, LOOKS)
            shift = np.linalg.norm(data.xpos[bodies] - place, axis=1) / size
            turn = np.linalg.norm(data.xmat[bodies] - frame, axis=1) / 8**0.5
            if not (np.isfinite(shift).all() and np.maximum(shift, turn).max() < MOVED):
                return "falls", f"moved by {data.time:.1f} s"
        return "holds", f"moved {np.maximum(shift, turn).max():.1e}"

    return run
