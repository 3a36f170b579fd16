"""Problem 2 answered in full: the stable orientation with the widest margin, or the nearest.

The stable cone says which directions of gravity are stable and which of them lies farthest from
the boundary. The verdict there is proved anew by contact forces. Where the cone is empty, one
motion a facet of the diamond proves that no direction is stable: it gains energy at every
corner of the facet, hence everywhere on it. Then the nearest direction is given.

The cone is that of the frictionless contacts that are modelled; more contacts and friction can
only make it wider. So a direction that is found is stable; where none is found and such
contacts exist, "none" is asked again with every force they might bring, else it is undecided.

References
----------
Mattikalli, Baraff, Khosla and Repetto (1993), sections 2.3 and 3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from kilter.analysis.answers import joints_answer
from kilter.analysis.check import check
from kilter.analysis.judge import Judgement, judge
from kilter.analysis.turning.facet_program import Joint, joint
from kilter.analysis.turning.nearest import Method, Nearest, NearestDirection, nearest, turned
from kilter.analysis.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance, find_contacts
from kilter.errors import InputError
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.program import Program, build_program
from kilter.rigid import rotation_between

if TYPE_CHECKING:
    from kilter.analysis.regions.friction_region import FrictionRegion
    from kilter.analysis.regions.region import Region

__all__ = [
    "Orientation",
    "candidate_directions",
    "least_turn",
    "orient",
    "orient_answer",
    "require_turnable",
    "tilt_margin_deg",
]

Word = Literal["found", "none", "undecided"]

OPPOSITE = 1e-12
"""Directions whose sum is this short are opposite."""


@dataclass(frozen=True, slots=True, eq=False)
class Orientation:
    """A stable orientation, or the nearest to stable.

    Attributes
    ----------
    verdict : {"found", "none", "undecided"}
    sentence : str
        The verdict in words.
    down : ndarray, shape (3,)
        Unit direction of gravity in the frame of the assembly: stable where found, else the
        nearest on the paper's diamond.
    rotation : ndarray, shape (4,)
        Quaternion (w, x, y, z) of the least turn that takes `down` to the gravity of the file.
    tilt_margin_deg : float or None
        From `down` to the nearest direction that is not stable; 0 where the region is thinner
        than space (than the plane, if planar); None where none was found.
    z : float
        LP (9) at `down`, gravity of length 1 (2-norm, as in `check`) [kg x length unit].
    instability : float
        kappa at `down` [-].
    nearest : Nearest or None
        Where none was found.
    method : {"joint", "walk"}
    programs : int
        Programs solved, verdicts left out.
    judgement : Judgement
        The proof at `down`.
    check : Verdict or None
        What moves at `down`, where none was found.
    region : Region
    warnings : tuple of str
    """

    verdict: Word
    sentence: str
    assembly: Assembly
    down: Array
    rotation: Array
    tilt_margin_deg: float | None
    z: float
    instability: float
    nearest: Nearest | None
    method: Method
    programs: int
    judgement: Judgement
    check: Verdict | None
    region: Region | FrictionRegion
    warnings: tuple[str, ...]

    @property
    def found(self) -> bool:
        """Whether `down` is stable, proved by forces."""
        return self.verdict == "found"

    @property
    def undecided(self) -> bool:
        """Whether neither was proved: a stable direction, or that there is none."""
        return self.verdict == "undecided"

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data."""
        return orient_answer(self)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        from kilter.tell.notebook import orientation_html

        return orientation_html(self)

    def __str__(self) -> str:
        return self.sentence


def orient(
    assembly: Assembly,
    contacts: ContactSet | None = None,
    *,
    tolerance: Tolerance | None = None,
    method: Method = "joint",
    progress: Callable[[str], None] | None = None,
) -> Orientation:
    """How could the assembly be turned so that it stays together?

    Parameters
    ----------
    assembly : Assembly
        At least one part must be held; no loads.
    contacts : ContactSet, optional
        Found from the geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.
    method : {"joint", "walk"}
        For the nearest direction on the paper's diamond.
    progress : callable, optional
        Called with a word at each stage.

    Raises
    ------
    InputError
        If nothing is held, loads are given, or the geometry is not usable.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> answer = orient(scene("paper-figure-11"))
    >>> answer.verdict, np.round(answer.down, 6) + 0.0
    ('found', array([-0.707107,  0.      , -0.707107]))
    """
    from kilter.analysis.regions.region import find_region

    tell = progress or (lambda stage: None)
    require_turnable(assembly, method)
    if contacts is None:
        contacts = find_contacts(assembly, tolerance=tolerance, progress=progress)
    program = build_program(assembly, contacts).frictionless
    tell("stable region")
    region = find_region(assembly, contacts=contacts)
    tell("orientation")
    for direction in candidate_directions(program, region):
        judgement = judge(turned(program, direction))
        if judgement.stable:
            return _found(assembly, program, region, direction, judgement, method)
    best = joint(program, every=True)
    judgement = judge(turned(program, best.gravity))
    if judgement.stable:
        return _found(assembly, program, region, best.gravity, judgement, method)
    tell("nearest to stable")
    near = nearest(program, method=method, solved=best)
    why = _open_questions(assembly, contacts, program, best)
    return _not_found(assembly, contacts, region, judgement, near, method, why)


def require_turnable(assembly: Assembly, method: str) -> None:
    """Refuse what is not held, or has loads, which do not turn."""
    if method not in ("joint", "walk"):
        raise InputError(f"there is no method {method!r}", hint="give 'joint' or 'walk'")
    assembly.require_grounded()
    if assembly.loads:
        raise InputError(
            "a load is fixed in the world and does not turn with the assembly",
            file=assembly.source or None,
            part=assembly.loads[0].part,
            hint="leave the loads out to look for an orientation",
        )


def candidate_directions(program: Program, region: Region | FrictionRegion) -> Iterator[Array]:
    """Directions that the region holds for stable, the one with the widest margin first."""
    down = program.gravity / float(np.linalg.norm(program.gravity))
    if region.center is not None:
        yield np.asarray(region.center)
    elif len(region.lines):  # a line, a plane, all: as near to gravity as it goes
        lines = np.asarray(region.lines)
        along = lines.T @ (lines @ down)
        # rounding of an exact zero must not become a direction
        length = float(np.linalg.norm(along))
        yield down if region.kind == "all" else along / length if length > 1e-9 else lines[0]
        yield from lines
    yield from np.asarray(region.rays).reshape(-1, 3)


def _found(
    assembly: Assembly,
    program: Program,
    region: Region,
    direction: Array,
    judgement: Judgement,
    method: Method,
) -> Orientation:
    down = direction / float(np.linalg.norm(direction)) + 0.0
    margin = tilt_margin_deg(program, region, down)
    return Orientation(
        verdict="found",
        sentence=f"Stable with gravity along {_words(down)} of the assembly's frame: "
        f"{_tilt_words(margin, region)}.",
        assembly=assembly,
        down=down,
        rotation=least_turn(assembly, down),
        tilt_margin_deg=margin,
        z=0.0,
        instability=0.0,
        nearest=None,
        method=method,
        programs=region.programs,
        judgement=judgement,
        check=None,
        region=region,
        warnings=region.warnings,
    )


def tilt_margin_deg(program: Program, region: Region | FrictionRegion, down: Array) -> float:
    """Angle from `down` to the boundary of the region [deg]; 0 where the region is thin."""
    if region.dimension < (2 if program.planar else 3):
        return 0.0
    if not len(region.cone.facets):
        return 180.0
    return float(np.degrees(np.arcsin(np.clip((region.cone.facets @ down).min(), 0.0, 1.0))))


def _not_found(
    assembly: Assembly,
    contacts: ContactSet,
    region: Region,
    judgement: Judgement,
    near: Nearest,
    method: Method,
    why: list[str],
) -> Orientation:
    """The answer where no direction was proved stable; `why` it may be undecided."""
    down = near.diamond.direction
    verdict = check(assembly.with_down(down), contacts=contacts)
    # the region has named the parts that touch nothing
    more = [text for text in verdict.warnings if not text.startswith("touches nothing")]
    if why:
        sentence = f"Undecided: {'; '.join(why)}."
    else:
        sentence = (
            f"No orientation is stable; the nearest has gravity along {_words(down)} of the "
            "assembly's frame, and here is what moves there."
        )
    return Orientation(
        verdict="undecided" if why else "none",
        sentence=sentence,
        assembly=assembly,
        down=down,
        rotation=least_turn(assembly, down),
        tilt_margin_deg=None,
        z=verdict.displacement.z,
        instability=verdict.motion.instability,
        nearest=near,
        method=method,
        programs=region.programs + near.programs,
        judgement=judgement,
        check=verdict,
        region=region,
        warnings=tuple(dict.fromkeys([*region.warnings, *more])),
    )


def _open_questions(
    assembly: Assembly, contacts: ContactSet, program: Program, best: Joint
) -> list[str]:
    """What keeps "no direction is stable" from being proved; nothing where it is proved."""
    if not _none_is_stable(program, best):
        return [
            "the numbers carry neither a proof that a direction is stable nor that none is "
            f"(best z = {best.z:.2g} of a mass of {float(program.mass[program.free].sum()):.2g} kg)"
        ]
    outer = build_program(assembly, contacts, possible=True, sticking=True).frictionless
    if len(outer.part_a) == len(program.part_a):
        return []
    if _none_is_stable(outer, joint(outer, every=True)):
        return []
    why = []
    if (contacts.patch_mu > 0).any():
        why.append("without friction no orientation is stable, and friction could hold one")
    if contacts.unsupported:
        why.append("contacts of a kind that is not modelled yet could hold it")
    return why or ["the polygon that stands for a round face could hold it, a circle might not"]


def _none_is_stable(program: Program, best: Joint) -> bool:
    """Whether the motion of each facet is a proof at every corner of the facet."""
    for facet in best.facets:
        for axis in np.flatnonzero(facet.signs):
            corner = np.zeros(3)
            corner[axis] = facet.signs[axis]
            if not check_motion(turned(program, corner), facet.motion).holds:
                return False
    return True


def least_turn(assembly: Assembly, down: Array) -> Array:
    """The least turn that takes `down` to the gravity of the file, shape (4,)."""
    opposite = float(np.linalg.norm(down + assembly.down)) < OPPOSITE
    if assembly.planar and opposite:
        return np.array([0.0, 0.0, 1.0, 0.0])
    return rotation_between(down, assembly.down) + 0.0


def _words(direction: Array) -> str:
    x, y, z = (round(float(c), 6) + 0.0 for c in direction)
    return f"({x:g}, {y:g}, {z:g})"


def _tilt_words(margin: float, region: Region) -> str:
    """How far it may tilt from there, and within what."""
    if margin >= 180.0:
        words = "it may be turned in any way"
    elif margin > 0:
        words = f"it may tilt by {margin:.4g} degrees"
    elif region.dimension > 1:
        half = region.half_angle_deg
        words = f"it may tilt by {half:.4g} degrees within the {region.kind}, not out of it"
    else:
        words = "it may not tilt at all"
    return words if region.exact else f"without friction {words}"


def orient_answer(orientation: Orientation) -> dict[str, Any]:
    """The answer of `kilter orient --json`."""
    near, verdict = orientation.nearest, orientation.check
    return {
        "verdict": orientation.verdict,
        "found": orientation.found,
        "sentence": orientation.sentence,
        "down": orientation.down.tolist(),
        "rotation": orientation.rotation.tolist(),
        "tilt_margin_deg": orientation.tilt_margin_deg,
        "z": orientation.z,
        "instability": orientation.instability,
        "units": orientation.assembly.units,
        "joints": joints_answer(orientation.assembly),
        "parts": [] if verdict is None else verdict.to_dict()["parts"],
        "nearest": None
        if near is None
        else {
            "diamond": _direction(near.diamond),
            "sphere": _direction(near.sphere),
            "kappa": {**_direction(near.kappa), "bound": near.kappa.bound},
        },
        "method": orientation.method,
        "programs": orientation.programs,
        "warnings": list(orientation.warnings),
    }


def _direction(one: NearestDirection) -> dict[str, Any]:
    motion = None if one.motion is None else (one.motion + 0.0).tolist()
    return {
        "direction": (one.direction + 0.0).tolist(),
        "value": one.value,
        "motion": motion,
        "programs": one.programs,
    }
