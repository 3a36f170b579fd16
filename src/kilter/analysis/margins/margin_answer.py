"""The answer of `kilter.margin`, and its proofs: forces within a limit, a motion beyond it.

Each limit belongs to a change of the assembly: gravity along another direction, a single
coefficient at every contact, further loads. Just within the limit forces hold the changed
assembly, just beyond it a motion starts; both are as near to the limit as they are proved.
`kilter.analysis.limit_check` compares the stated value with the change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import numpy as np

from kilter.analysis.analysis_tolerances import AROUND_LIMIT
from kilter.analysis.decision.bond_factor import BondFactor
from kilter.analysis.decision.judge import judge
from kilter.analysis.gradients.gradient import Gradient, gradient_of
from kilter.analysis.load_limit import Limit, Why
from kilter.analysis.margins.least_friction import LeastFriction
from kilter.analysis.margins.level_limits import LevelLimits
from kilter.analysis.margins.make_stand import MadeStand
from kilter.analysis.margins.part_limits import PartLoad, Push
from kilter.analysis.margins.solved_limits import limit_cases
from kilter.analysis.margins.tilt import NearestHeld, TiltAbout, TiltMargin
from kilter.analysis.margins.tried_changes import TriedChange
from kilter.analysis.margins.uncertainty import Uncertainty
from kilter.analysis.verdict.answers import OfAssembly
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import TINY, Array, cross
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, has_round_edges
from kilter.mechanics.bundle import apply_change, make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.tell.record import (
    Ends,
    Guarantee,
    InPython,
    LevelWord,
    Record,
    Seconds,
    Vector,
    Word,
    key,
)

Change = Callable[[float], dict[str, Any]]
About = tuple[dict[str, Any], dict[str, Any]]


class Bracket(Record):
    """Bounds of the least and of the greatest load factor, if slipping contacts do not dilate.

    The inner bounds are held however slippery the parts.
    """

    least: Ends | None
    """Bounds of the least factor."""
    greatest: Ends | None
    """Bounds of the greatest factor."""


class Margin(OfAssembly):
    """Answer of `kilter.margin`: limits of tilt, friction, load factor and pushes."""

    answer: ClassVar[str] = "margin"

    check: InPython[Verdict]
    """Answer of `kilter.check`."""
    program: InPython[Program]
    """The modelled contacts, with friction."""
    verdict: Word
    """Verdict of `kilter.check`."""
    sentence: str
    """The verdict in words."""
    guarantee: Guarantee
    """Guarantee of the verdict."""
    level: LevelWord
    """Level of the limits: "proved" without friction, else "equilibrium"."""
    require: LevelWord
    """Level of `at_level`."""
    tilt: InPython[TiltMargin | None]
    """None if gravity as given is not held, with loads, or if the region is thinner than a cone."""
    nearest: InPython[NearestHeld | None]
    """Least turn that is held, from both sides, if gravity as given is not held."""
    tilt_deg: float | None
    """Least turn of gravity to the boundary [deg]; negative when outside."""
    tilt_outside: Word | None
    """Verdict of `kilter.check` just beyond the tilt limit, at the level "equilibrium"."""
    at_level: LevelLimits | None
    """Values up to which the level `require` is reached, if it is above "equilibrium"."""
    tilt_lower_deg: float | None
    """Turn that is proved to be held in every direction [deg]."""
    tilt_upper_deg: float | None
    """Turn that is proved not to reach a held direction, negative [deg]."""
    tilt_down: Vector | None
    """Direction of gravity at the limit; None if no tilt up to a right angle fails."""
    tilt_limit: Limit | None
    """Proofs of the tilt."""
    about: TiltAbout | None
    """Turn about the given axis."""
    friction: float | None
    """Least coefficient, the same at every contact [-]; None if none is enough."""
    friction_limit: LeastFriction | None
    """Proof of the least friction coefficient."""
    clamped_by: tuple[str, ...]
    """Bonds and straps, of which `bond` is the needed share."""
    bond: float | None
    """Least share of the strength of bonds and straps that is enough [-]; None if it is 0."""
    bond_limit: BondFactor | None
    """Proof of the least share of the bond strength; None if no share is enough."""
    load_factor: Ends | None
    """Least and greatest load factor [-], infinite without a limit; None without loads."""
    load_factor_bracket: Bracket | None
    """Bounds of the load factor without dilation, if requested."""
    load_limits: tuple[Limit | None, Limit | None] | None
    """Proofs of both ends; the values of the least have the opposite sign."""
    pushes: tuple[Push, ...]
    """Weakest push of each part."""
    loads: tuple[PartLoad, ...]
    """Additional load straight down of each part; empty if it was not requested."""
    push: InPython[Vector | None]
    """Direction of the body force of `load_factor`; None if the factor is that of the loads."""
    edges: InPython[tuple[RoundEdge, ...]]
    """Round edges over which parts tip, in the tilt."""
    missing: dict[str, Why]
    """Requested limits without a value, and why: "none", proved that there is none (it is not held
    as given, or no friction or factor is enough); "failed", the numbers did."""
    uncertainty: Uncertainty | None
    """The worst case of inexact data; None without ranges, or if there are too many cases."""
    improvements: tuple[TriedChange, ...]
    """Changes that raise the tilt margin, or else the load factor, or lower the least friction
    most, each tried; empty if they were not requested."""
    made_stand: MadeStand | None
    """The least change after which it stands with a tilt margin; null if it was not requested."""
    warnings: tuple[str, ...]
    """Warnings about the assembly and its contacts."""
    seconds: Seconds
    """Duration of each stage [s]."""

    @property
    @key
    def exact(self) -> bool:
        """Whether all limits are those of the solids: no open pair, and no polygon for a circle.

        Only the tilt counts round edges as circles; every other limit is that of polygons inside.
        """
        if self.contacts.open_pairs:
            return False
        others = self.about, self.load_limits, self.bond_limit, self.uncertainty, *self.pushes
        tilts = self.tilt is not None and not (any(others) or self.loads)
        tilts = tilts and not self.friction
        known = self.edges if tilts and self.tilt is not None and self.tilt.closed else ()
        return not has_round_edges(self.assembly, self.contacts, known)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces within each limit and a motion beyond it, for `kilter.verify`, as JSON data.

        Raises
        ------
        InputError
            If no limit is known.
        """
        return make_bundle("margin", margin_proofs(self, options=options or {}))

    def gradient(self, of: str | None = None, *, part: str | None = None) -> Gradient:
        """Derivatives of a limit by positions, masses, friction, loads and shapes of the parts.

        The forces and the motion of the limit give them, without a further optimisation.

        Parameters
        ----------
        of : {"tilt", "friction", "load factor", "least load factor", "push", "load"}, optional
            The limit; by default the tilt, else the greatest load factor, else the least friction.
        part : str, optional
            The part that is pushed or loaded.

        Raises
        ------
        InputError
            If the answer has no finite limit of this kind, or the assembly has bonds, straps or
            springs.

        Examples
        --------
        >>> import kilter
        >>> box = kilter.Part("box", kilter.Box(1, 1, 2), [0, 0, 1])
        >>> table = kilter.Part("table", kilter.Box(9, 9, 1), [0, 0, -0.5], grounded=True)
        >>> gradient = kilter.margin(kilter.Assembly([table, box], friction=0.9)).gradient("tilt")
        >>> [round(float(slope), 4) for slope in gradient.center[1, 2]]  # degrees per metre
        [-22.9183, -22.9183]
        """
        if of is None:
            greatest = None if self.load_limits is None else self.load_limits[1]
            finite = greatest is not None and np.isfinite(greatest.value)
            tilts = self.tilt is not None and self.tilt.angle < np.pi / 2
            of = "tilt" if tilts else "load factor" if finite else "friction"
        return gradient_of(self.assembly, self.contacts, limit_cases(self, of, part))

    def __repr__(self) -> str:
        tilt = "none" if self.tilt_deg is None else f"{self.tilt_deg:.6g} deg"
        if self.tilt is not None and self.tilt_down is None:
            tilt = "over 90 deg"
        mu = "none" if self.friction is None else f"{self.friction:.6g}"
        if self.friction_limit is not None and not self.friction_limit.attained:
            mu = f"above {mu}"
        return f"Margin({self.verdict}, tilt {tilt}, least friction {mu})"


def margin_proofs(limits: Margin, *, options: dict[str, Any]) -> list[About]:
    """Proofs of every limit of a margin: tilts, friction, bonds, load factors, pushes, loads.

    If no limit has a proof, the proof is about the undisturbed assembly, the tilt 0.
    """
    proofs = []
    for what, (within, beyond), change, upwards, motion, more in _limits(limits):
        steps = AROUND_LIMIT if within == beyond else (0.0, *AROUND_LIMIT)
        for held in (True, False):
            sign = -1.0 if held == upwards else 1.0
            value = within if held else beyond
            for step in steps:
                at = value + sign * step * max(abs(value), 1.0)
                if at < 0 and what in ("friction", "bond"):
                    break
                data = _proof(limits, change(at), held, None if held else motion, options)
                if data is not None:
                    unit = more.get("unit", 1.0)
                    about = {"about": what, "value": at * unit, "held": held, "change": change(at)}
                    proofs.append((about | more.get("data", {}), data))
                    break
    if not proofs:  # for example without friction, where every tilt is beyond the limit
        undisturbed = {"down": limits.assembly.down.tolist()}
        for held in (True, False):
            data = _proof(limits, undisturbed, held, None, options)
            if data is not None:
                about = {"about": "tilt", "value": 0.0, "held": held, "change": undisturbed}
                return [(about, data)]
    return proofs


def _limits(
    limits: Margin,
) -> Iterator[tuple[str, tuple[float, float], Change, bool, MotionProof | None, dict[str, Any]]]:
    """Yield for each limit its name, a value on each side, the change of the file, and the motion.

    A flag states whether larger values are beyond the limit. The last entry has the unit of the
    stated value, and further data of the statement.

    The sides are the values that are held and not held, if both are proved; else a single value.
    """
    tilt, nearest, friction, bond = limits.tilt, limits.nearest, limits.friction_limit, limits.bond
    down = limits.program.down
    if tilt is not None and tilt.limit.motion is not None and (tilt.down != down).any():
        sides = tilt.angle, tilt.angle
        yield "tilt", sides, _turn_gravity(down, tilt.down), True, tilt.limit.motion, {}
    about = limits.about
    if about is not None and np.isfinite(about.tilt_deg):
        angle = float(np.radians(about.tilt_deg))
        turned = _turn_gravity(down, cross(about.axis, down))
        more = {"data": {"axis": about.axis.tolist()}}
        yield "tilt about the axis", (angle, angle), turned, True, about.limit.motion, more
    if nearest is not None and (nearest.down != down).any():
        sides = nearest.angle, nearest.lower
        yield "nearest held", sides, _turn_gravity(down, nearest.down), False, nearest.motion, {}
    if friction is not None and friction.value > 0 and friction.attained:
        sides = friction.value, friction.lower
        yield "friction", sides, lambda mu: {"mu": mu}, False, friction.motion, {}
    if limits.bond_limit is not None and bond is not None:
        motion = limits.bond_limit.limit.motion
        yield "bond", (bond, bond), lambda share: {"strength": share}, False, motion, {}
    least, greatest = limits.load_limits or (None, None)
    scaled = _scale_loads(limits)
    more = {} if limits.push is None else {"data": {"push": limits.push.tolist()}}
    if greatest is not None and np.isfinite(greatest.value):
        sides = greatest.value, greatest.value
        yield "load factor", sides, scaled, True, greatest.motion, more
    if least is not None and np.isfinite(least.value):
        sides = -least.value, -least.value
        yield "least load factor", sides, scaled, False, least.motion, more
    for push in limits.pushes:
        if np.isfinite(push.force):
            weight = float(limits.program.weight[limits.program.free].sum())
            pushed = _push_part(limits.assembly, push.part, push.direction * weight)
            sides = push.force / weight, push.force / weight
            share = {"unit": weight}
            yield f"push of {push.part}", sides, pushed, True, push.limit.motion, share
    for load in limits.loads:
        if 0 < load.load < np.inf:
            within, beyond = load.load / load.unit, load.beyond / load.unit
            sides = within, beyond if np.isfinite(beyond) else within
            pressed = _push_part(limits.assembly, load.part, down * load.unit)
            share = {"unit": load.unit}
            yield f"load on {load.part}", sides, pressed, True, load.limit.motion, share


def _turn_gravity(down: Array, toward: Array) -> Change:
    """Function from an angle [rad] to a changed file, with gravity turned `toward` a direction."""
    aside = toward - (toward @ down) * down
    aside = aside / max(float(np.linalg.norm(aside)), TINY)
    return lambda angle: {"down": (np.cos(angle) * down + np.sin(angle) * aside).tolist()}


def _load(part: str, force: Array, torque: Array, point: Array | None = None) -> dict[str, Any]:
    where = None if point is None else point.tolist()
    return {"part": part, "force": force.tolist(), "torque": torque.tolist(), "point": where}


def _scale_loads(limits: Margin) -> Change:
    """Function from a load factor to a changed file, with scaled loads or a body force."""
    assembly, program = limits.assembly, limits.program
    if limits.push is None:
        return lambda share: {
            "loads": [
                _load(load.part, share * load.force, share * load.torque, load.point)
                for load in assembly.loads
            ]
        }
    given = [_load(load.part, load.force, load.torque, load.point) for load in assembly.loads]
    push = limits.push * program.g
    return lambda share: {
        "loads": given
        + [
            _load(name, share * mass * push, np.zeros(3))
            for name, mass, free in zip(program.names, program.mass, program.free, strict=True)
            if free
        ]
    }


def _push_part(assembly: Assembly, part: str, force: Array) -> Change:
    given = [_load(load.part, load.force, load.torque, load.point) for load in assembly.loads]
    return lambda share: {"loads": [*given, _load(part, share * force, np.zeros(3))]}


def _proof(
    limits: Margin,
    change: dict[str, Any],
    held: bool,
    motion: MotionProof | None,
    options: dict[str, Any],
) -> dict[str, Any] | None:
    """Proof that the assembly after a change holds or falls; None if there is no proof."""
    return changed_proof(limits.assembly, limits.contacts, change, held, motion, options)


def changed_proof(
    assembly: Assembly,
    contacts: ContactSet,
    change: dict[str, Any],
    held: bool,
    motion: MotionProof | None,
    options: dict[str, Any],
) -> dict[str, Any] | None:
    """Proof of a changed assembly: forces that hold it, or a motion; None without a proof."""
    assembly, contacts = apply_change(assembly, contacts, change)
    # no force that was left out may stop a motion
    program = build_program(assembly, contacts, possible=not held)
    proof: ForceProof | MotionProof | None = None
    if motion is not None:
        proof = check_motion(program, motion.motion)
    if proof is None or not proof.holds:
        judged = judge(program)
        proof = judged.forces if held else judged.motion
    if proof is None or not proof.holds:
        return None
    evidence = Evidence("open") if program.mu.any() else None
    return make_proof(assembly, contacts, program, proof, options, evidence=evidence)
