"""Masses and friction of MuJoCo models by the engine, beside those of kilter; random models."""

from collections import defaultdict
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import kilter
from kilter import Assembly

LEAST = 1e-5
"""The engine raises smaller friction coefficients to this value [-]."""
AGREES = 1e-9
"""Largest relative difference of masses, centres and inertia; files state more digits."""


def placed(model: Any) -> Any:
    """The data of a model in the pose of its first keyframe, if any, with its contacts."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return data


def reduced(path: Path) -> Any:
    """The model of a file without height fields, and with at most a joint for each body.

    What remains has the same masses, inertia and rules for contacts. It has gravity.
    """
    spec = mujoco.MjSpec.from_file(str(path))
    fields = int(mujoco.mjtGeom.mjGEOM_HFIELD), int(mujoco.mjtGeom.mjGEOM_SDF)
    gone = [geom for geom in spec.geoms if int(geom.type) in fields]
    for kind in ("actuators", "sensors", "tendons", "equalities", "keys"):
        gone += list(getattr(spec, kind))
    for body in spec.bodies:
        gone += list(body.joints)[1:]
    for element in gone:
        spec.delete(element)
    spec.option.gravity = [0, 0, -9.81]
    spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    return spec.compile()


def summed(masses: Any, centers: Any, tensors: Any) -> tuple[float, Any, Any]:
    """Mass, centre, and inertia about the centre of rigidly joined bodies, world axes."""
    masses, centers = np.array(masses), np.array(centers)
    mass = masses.sum()
    center = masses @ centers / mass
    total = np.zeros((3, 3))
    for one, place, tensor in zip(masses, centers - center, tensors, strict=True):
        total += tensor + one * (place @ place * np.eye(3) - np.outer(place, place))
    return mass, center, total


def owner_names(model: Any, assembly: Assembly) -> dict[int, list[str]]:
    """Names of the parts of each group of bodies that move together, by the first body."""
    groups = defaultdict(list)
    for body in range(1, model.nbody):
        name = model.body(body).name or f"body_{body}"
        if name in assembly:
            groups[int(model.body_weldid[body])].append(name)
    return groups


def mass_differences(model: Any, data: Any, assembly: Assembly) -> list[str]:
    """Groups of bodies that move together, whose mass, centre or inertia differ."""
    found = []
    geometry = assembly.geometry
    for root, names in owner_names(model, assembly).items():
        if root == 0 or model.body_mocapid[root] >= 0:
            continue
        bodies = [k for k in range(model.nbody) if model.body_weldid[k] == root]
        turns = [data.ximat[k].reshape(3, 3) for k in bodies]
        tensors = [
            turn @ np.diag(model.body_inertia[k]) @ turn.T
            for k, turn in zip(bodies, turns, strict=True)
        ]
        true = summed(model.body_mass[bodies], data.xipos[bodies], tensors)
        rows = [assembly.index_of(name) for name in names]
        mine = summed(geometry.mass[rows], geometry.center[rows], geometry.inertia[rows])
        size = float(np.sqrt(np.trace(true[2]) / true[0]))
        scales = (true[0], max(size, float(np.abs(true[1]).max())), np.abs(true[2]).max())
        for what, value, wanted, scale in zip(
            ("mass", "centre", "inertia"), mine, true, scales, strict=True
        ):
            off = float(np.abs(np.asarray(value) - wanted).max() / scale)
            if off > AGREES:
                found.append(f"{what} of {', '.join(names)} differs by {off:.2g} of it")
    return found


def engine_friction(model: Any, data: Any) -> dict[frozenset[str], set[float]]:
    """Friction coefficients of the contacts of the engine, by the names of their parts."""
    found = defaultdict(set)
    for contact in data.contact:
        ends = set()
        for geom in (contact.geom1, contact.geom2):
            body = int(model.geom_bodyid[geom])
            plane = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE
            usual = "floor" if plane else "world"
            ends.add(
                (model.body(body).name or f"body_{body}")
                if body
                else (model.geom(geom).name or usual)
            )
        mu = 0.0 if contact.dim == 1 else float(min(contact.friction[:2]))
        found[frozenset(ends)].add(0.0 if mu <= LEAST else mu)
    return found


def stated_friction(assembly: Assembly, pair: frozenset[str]) -> set[float]:
    """Friction coefficients that an assembly states for a pair of parts and for their pieces."""
    apart = [entry for entry in assembly.contacts if frozenset(entry.parts) == pair]
    if any(entry.pieces is None for entry in apart):
        return set()
    entries = [entry for entry in assembly.friction_pairs if frozenset(entry.parts) == pair]
    usual = set() if any(entry.pieces is None for entry in entries) else {assembly.friction}
    return usual | {entry.mu for entry in entries}


def friction_differences(
    model: Any,
    data: Any,
    assembly: Assembly,
    *,
    complete: bool = False,
    time_limit: float | None = None,
) -> tuple[list[str], int]:
    """Pairs whose friction differs from that of the engine, and the number of compared pairs.

    A coefficient of a patch must be one of the engine's contacts of the pair. For pairs without a
    patch, such as overlapping parts, those of the engine must be stated. With `complete` the sets
    must be equal, and the same pairs must touch.
    """
    true = engine_friction(model, data)
    mine = defaultdict(set)
    for patch in kilter.contacts(assembly, time_limit=time_limit):
        mine[frozenset(patch.parts)].add(patch.mu)
    found = []
    compared = 0
    for pair in mine.keys() | true.keys():
        theirs, ours = true.get(pair, set()), mine.get(pair, set())
        if not complete:
            if not theirs or not all(name in assembly for name in pair):
                continue  # the engine has no contact, or the geom belongs to another part
            known = (
                within(ours, theirs) if ours else within(theirs, stated_friction(assembly, pair))
            )
        else:
            known = bool(ours) and within(ours, theirs) and within(theirs, ours)
        compared += 1
        if not known:
            found.append(f"friction of {' and '.join(sorted(pair))}: {ours}, engine {theirs}")
    return found, compared


def within(some: set[float], all_of: set[float]) -> bool:
    """Whether each number agrees with a number of the other set; the engine has no zero."""
    off = [min((abs(a - b) for b in all_of), default=1.0) for a in some]
    return all(gap <= (AGREES if a > LEAST else LEAST) for a, gap in zip(some, off, strict=True))


def random_model(seed: int) -> str:
    """A model of bodies with several feet of random friction, priority, pairs and inertia.

    Every foot stands on one of two floors. Some bodies have a welded child without mass or
    without geoms.
    """
    rng = np.random.default_rng(seed)

    def some(values: Any) -> Any:
        return values[rng.integers(len(values))]

    def geom_rule() -> str:
        words = f'friction="{rng.uniform(0.05, 1):.3f} .01 .001" condim="{some((1, 3, 3, 4, 6))}"'
        words += f' priority="{some((0, 0, 0, 1, 2))}"'
        bits = some(("1 1", "1 1", "1 1", "1 2", "2 1", "3 3", "4 0"))
        return words + ' contype="{}" conaffinity="{}"'.format(*bits.split())

    floors = [
        f'<geom name="floor{k}" type="box" size="3 3 .5" pos="{6 * k} 0 -.5" {geom_rule()}/>'
        for k in (0, 1)
    ]
    bodies, feet = [], []
    for b in range(int(rng.integers(2, 5))):
        place = f"{6 * int(rng.integers(2)) + some((-0.9, 0.9)) + 0.1 * b:.3f} {2 * b - 3} .3"
        inside = [f'<geom type="box" size=".4 .3 .1" pos="0 0 .1" {geom_rule()}/>']
        for k, (x, y) in enumerate([(-0.3, -0.2), (-0.3, 0.2), (0.3, 0)]):
            feet.append(f"foot{b}_{k}")
            height = 0.2  # the upper ends of the feet are inside of the plate
            inside.append(
                f'<geom name="foot{b}_{k}" type="box" size=".05 .05 {height}" '
                f'pos="{x} {y} -.1" mass="{rng.uniform(0.1, 3):.3f}" {geom_rule()}/>'
            )
        kind = rng.integers(4)
        if kind == 0:
            spread = rng.uniform(0.5, 2, 3)
            tensor = [spread[1] + spread[2], spread[0] + spread[2], spread[0] + spread[1]]
            inside.append(
                f'<inertial pos="{rng.uniform(-0.1, 0.1):.3f} 0 .05" mass="{rng.uniform(1, 9):.3f}"'
                f' fullinertia="{" ".join(f"{x:.6f}" for x in tensor)} .1 -.05 .08"/>'
            )
        elif kind == 1:
            inside.append(
                f'<body name="cap{b}" pos=".1 0 .3" euler="20 10 0"><geom type="box" mass="0" '
                f'size=".1 .1 .1" {geom_rule()}/></body>'
            )
        elif kind == 2:
            inside.append(
                f'<body name="weight{b}" pos=".1 .2 .3" euler="20 10 0"><inertial pos=".1 0 0" '
                f'mass="{rng.uniform(1, 9):.3f}" diaginertia=".3 .2 .15" euler="5 6 7"/></body>'
            )
        bodies.append(f'<body name="b{b}" pos="{place}"><freejoint/>{"".join(inside)}</body>')
    pairs = {(f"floor{some((0, 1))}", some(feet)) for _ in range(int(rng.integers(4)))}
    explicit = [
        f'<pair geom1="{a}" geom2="{b}" condim="{some((1, 3, 4))}" '
        f'friction="{rng.uniform(0.05, 1):.3f} {rng.uniform(0.05, 1):.3f}"/>'
        for a, b in sorted(pairs)
    ]
    if rng.random() < 0.2:
        explicit.append('<exclude body1="world" body2="b0"/>')
    return (
        '<mujoco><option gravity="0 0 -9.81"/><worldbody>'
        + "".join(floors + bodies)
        + f"</worldbody><contact>{''.join(explicit)}</contact></mujoco>"
    )
