"""Friction pairs, loads, given contacts and joints: interactions of parts, given by the user."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.assembly.assembly_tolerances import ACROSS, PLANAR_AXIS
from kilter.assembly.feature import Feature
from kilter.errors import InputError, nearest_name
from kilter.rigid import in_brackets, unit
from kilter.tell.record import OrAbsent, Record
from kilter.validate import finite, frozen, in_range, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

JointKind = Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical", "general"]
KINDS: tuple[JointKind, ...] = get_args(JointKind)
NEEDS_POINT = ("revolute", "cylindrical", "spherical")
"""Kinds of joints that need a point."""
NEEDS_AXIS = ("revolute", "prismatic", "cylindrical")
"""Kinds of joints that need an axis."""
FREE_AXES = ("slides", "turns")
"""Members of a general joint: the directions along which, and axes about which it moves."""
INDEPENDENT = 1e-6
"""Least singular value of the independent directions of a general joint [-]."""
GUIDED = ("revolute", "prismatic")
"""Kinds of joints with a single free motion, which may have limits, friction and a spring."""


def _piece_pair(pieces: Any, what: str) -> tuple[int, int] | None:
    """A pair of piece numbers, or None; `what` names the entry in the message of an error."""
    if pieces is None:
        return None
    pair = tuple(pieces) if isinstance(pieces, tuple | list) else ()
    if len(pair) != 2 or not all(type(piece) is int and piece >= 0 for piece in pair):
        raise InputError(
            f"pieces of a {what} are {pieces!r:.60}",
            hint="give the number of the piece of each part, such as [0, 1]",
        )
    return pair


def _names(parts: Any) -> tuple[str, ...]:
    """Convert names of parts to a tuple; the assembly checks how many there are."""
    names = tuple(parts) if isinstance(parts, tuple | list) else ()
    if not names or not all(isinstance(name, str) for name in names):
        raise InputError(f"parts are {parts!r:.60}", hint="give a pair of names")
    return names


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class FrictionPair(Value):
    """Friction coefficient of all contacts between two parts, or between a piece of each.

    Parameters
    ----------
    parts : tuple of str
        Names of the two parts.
    mu : float
        Friction coefficient [-].
    pieces : pair of int, optional
        Numbers of the pieces of both parts that the coefficient is for (`Mesh.pieces`; 0 for other
        shapes). It counts before the coefficient of the whole parts.

    Raises
    ------
    InputError
        If `mu` is negative or not a number, or `pieces` are not two numbers.
    """

    parts: tuple[str, str]
    mu: float
    pieces: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _names(self.parts))
        object.__setattr__(self, "mu", number(self.mu, "friction coefficient", lowest=0))
        object.__setattr__(self, "pieces", _piece_pair(self.pieces, "friction pair"))

    @property
    def subject(self) -> frozenset[Any]:
        """The parts, or the pieces of parts, that the coefficient is for, in either order."""
        if self.pieces is None:
            return frozenset(self.parts)
        return frozenset(zip(self.parts, self.pieces, strict=True))


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Load(Value):
    """A force [N] at a point and a torque [N x length unit] on a part, fixed in the world.

    Loads do not turn with the assembly.

    Parameters
    ----------
    part : str
        Name of the part.
    force : array_like, shape (3,)
        Force, world frame [N].
    torque : array_like, shape (3,)
        Torque in addition to that of the force, world frame [N x length unit].
    point : array_like, shape (3,), optional
        Point of attack of the force, world frame [length unit]; default the part's centre of
        mass.

    Raises
    ------
    InputError
        If a number is not finite.
    """

    part: str
    force: Any = (0.0, 0.0, 0.0)
    torque: Any = (0.0, 0.0, 0.0)
    point: Any = None

    def __post_init__(self) -> None:
        for name in ("force", "torque", "point"):
            value = getattr(self, name)
            if value is None and name == "point":
                continue
            try:
                value = finite(value, (3,), f"{name} of a load")
                in_range(value, f"{name} of a load")
            except InputError as error:
                raise error.located(part=self.part) from None
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        words = [f"{name}={in_brackets(getattr(self, name))}" for name in ("force", "torque")]
        at = "" if self.point is None else f", point={in_brackets(self.point)}"
        return f"Load({self.part!r}, {', '.join(words)}{at})"


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class GivenContact(Value):
    """Contact points of two parts given by the user; no contacts of that pair are detected.

    Parameters
    ----------
    parts : tuple of str
        Names of the two parts.
    points : array_like, shape (n, 3)
        Contact points, world frame [length unit]. Without points the two parts do not touch.
    normal : array_like, shape (3,)
        Surface normal from the first part to the second, world frame, of any length.
    mu : float, optional
        Friction coefficient [-]; default that of the assembly.
    feature : pair of Feature, optional
        Features of the first and of the second part at the contact; without them the
        second-order test is undecided.
    pieces : pair of int, optional
        Numbers of the pieces of both parts that do not touch, for a contact without points; the
        contacts of other pieces are detected.

    Raises
    ------
    InputError
        If a number is not finite, the normal is zero, a feature is along the normal, or a contact
        with points has pieces.
    """

    parts: tuple[str, str]
    points: Any
    normal: Any
    mu: float | None = None
    feature: tuple[Feature, Feature] | None = None
    pieces: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _names(self.parts))
        object.__setattr__(self, "pieces", _piece_pair(self.pieces, "contact"))
        if self.pieces is not None and len(self.points):
            raise InputError(
                f"contact of {self.parts[0]!r} and {self.parts[1]!r} has points and pieces",
                hint="give pieces only to a contact without points: they do not touch",
            )
        points = frozen(self.points, (-1, 3)) if len(self.points) else np.empty((0, 3))
        if not np.isfinite(points).all():
            raise InputError(
                f"contact of {self.parts[0]!r} and {self.parts[1]!r} has no valid points",
                hint="give finite numbers",
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "normal", unit(self.normal, "normal of a contact"))
        if self.mu is not None:
            object.__setattr__(self, "mu", number(self.mu, "friction coefficient", lowest=0))
        if self.feature is not None:
            object.__setattr__(self, "feature", self._features())

    def _features(self) -> tuple[Feature, Feature]:
        """The touching features of both parts; raises `InputError` for contradictory data."""
        given = tuple(self.feature) if isinstance(self.feature, tuple | list) else ()
        label = f"contact of {self.parts[0]!r} and {self.parts[1]!r}"
        if len(given) != 2 or not all(isinstance(feature, Feature) for feature in given):
            raise InputError(
                f"feature of the {label} is {self.feature!r:.60}",
                hint="give a pair of kilter.Feature, of the first part and of the second",
            )
        for feature, outward in zip(given, (self.normal, -self.normal), strict=True):
            if feature.along is not None and abs(float(feature.along @ self.normal)) > ACROSS:
                raise InputError(
                    f"the direction of a feature of the {label} is not perpendicular to the normal",
                    hint="give it a direction in the tangent plane",
                )
            if feature.axis is not None and feature.off_axis(self.points, outward) > ACROSS:
                raise InputError(
                    f"a feature of the {label} is not a surface of revolution about its axis",
                    hint="the normal must meet the axis, and the curvature around the axis must "
                    "be 1 / (distance to the axis along the normal), negative if hollow",
                )
        return given[0], given[1]

    def __repr__(self) -> str:
        mu = "" if self.mu is None else f", mu={self.mu:g}"
        mu += "" if self.feature is None else f", {self.feature[0].kind} on {self.feature[1].kind}"
        normal = in_brackets(self.normal)
        return f"GivenContact({self.parts}, {len(self.points)} points, normal={normal}{mu})"


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Joint(Value):
    """A joint of two parts, or of a part and the ground, that can push and pull.

    It transmits forces in both senses along each constrained direction.

    =============  ===============================  =================  =======
    kind           free motions                     `point`            `axis`
    =============  ===============================  =================  =======
    fixed          nothing                          optional           unused
    revolute       turning about the axis           on the axis        needed
    prismatic      sliding along the axis           optional           needed
    cylindrical    sliding along, turning about it  on the axis        needed
    spherical      turning about the point          centre             unused
    general        sliding along each of `slides`,  common to all      unused
                   turning about each of `turns`    axes of `turns`
    =============  ===============================  =================  =======

    The directions of `slides` move with the first part. They end in a frame in which the second
    part turns about each of `turns` in sequence: the first of these axes moves with the first part,
    the last with the second part. Two slides and a turn across them are a planar joint, two turns
    a universal joint.

    The position q of a revolute or prismatic joint is how far the first part has turned about the
    axis, or slid along it, relative to the second part. It is 0 in the drawn pose, in [rad] or
    [length unit]. The force or torque along the axis on the first part is

        stop        >= 0 at the lower limit, <= 0 at the upper limit, else 0
        friction    of either sign, at most `friction`
        spring      -stiffness (q - rest)

    Parameters
    ----------
    parts : pair of str
        Names of the parts; "ground" is the world.
    kind : str
    point, axis : array_like, shape (3,)
        Point and axis, world frame; proofs state the wrench of the joint about `point`.
    limits : pair of float, optional
        Least and largest position [rad] or [length unit].
    friction : float
        Largest friction [N x length unit] or [N].
    stiffness : float
        [N x length unit / rad] or [N / length unit].
    rest : float
        Position at which the spring has no force [rad] or [length unit].
    why : str
        Reason of a joint that `kilter.fastened` has added without naming the pair.
    slides, turns : array_like, shape (k, 3)
        Directions of a general joint, world frame, up to three independent ones of each.

    Raises
    ------
    InputError
        If the kind is unknown, or the kind needs a point or axis that is missing; if another kind
        has limits, friction or a spring, or if these are no valid numbers; if the directions of a
        general joint depend on each other, or another kind has such directions.

    Examples
    --------
    >>> Joint(("door", "frame"), "revolute", point=[0, 0, 1])
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: revolute joint of 'door' and 'frame' has no axis; give "axis", ...
    """

    parts: tuple[str, str]
    kind: JointKind = "fixed"
    point: Any = None
    axis: Any = None
    why: str = ""
    limits: tuple[float, float] | None = None
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    slides: Any = ()
    turns: Any = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _names(self.parts))
        label = " and ".join(repr(name) for name in self.parts)
        if self.kind not in KINDS:
            near = nearest_name(str(self.kind), KINDS)
            hint = f"did you mean {near!r}?" if near else f"give one of {', '.join(KINDS)}"
            raise InputError(f"joint of {label} has the kind {self.kind!r}", hint=hint)
        label = f"{self.kind} joint of {label}"
        if self.point is None and self.kind in NEEDS_POINT:
            place = "its centre" if self.kind == "spherical" else "a point on the axis"
            raise InputError(f"{label} has no point", hint=f'give "point", {place}')
        if self.axis is None and self.kind in NEEDS_AXIS:
            what = "slides along" if self.kind == "prismatic" else "turns about"
            raise InputError(f"{label} has no axis", hint=f'give "axis", the direction it {what}')
        if self.point is not None:
            object.__setattr__(self, "point", finite(self.point, (3,), f"point of the {label}"))
        if self.axis is not None:
            object.__setattr__(self, "axis", unit(self.axis, f"axis of the {label}"))
        self._require_free_axes(label)
        self._require_guide(label)

    def _require_free_axes(self, label: str) -> None:
        """Verify the directions of a general joint; `label` names the joint in error messages."""
        for name in FREE_AXES:
            rows = [unit(row, f"direction in {name} of the {label}") for row in getattr(self, name)]
            axes = frozen(np.array(rows).reshape(-1, 3), (-1, 3))
            if rows and self.kind != "general":
                raise InputError(
                    f"the {label} has {name}", hint="only joints of the kind general have them"
                )
            sizes = np.linalg.svd(axes, compute_uv=False) if rows else np.ones(1)
            if len(rows) > 3 or sizes.min() < INDEPENDENT:
                raise InputError(
                    f"the {name} of the {label} depend on each other",
                    hint="give up to three independent directions",
                )
            object.__setattr__(self, name, axes)
        if self.kind == "general" and len(self.turns) and self.point is None:
            raise InputError(f"{label} has no point", hint='give "point", on all axes of its turns')

    def _require_guide(self, label: str) -> None:
        """Verify limits, friction and spring; `label` names the joint in error messages."""
        if self.limits is not None:
            low, high = finite(self.limits, (2,), f"limits of the {label}").tolist()
            if low > high:
                raise InputError(
                    f"the limits of the {label} are {low:g} and {high:g}",
                    hint="give the lower limit first",
                )
            object.__setattr__(self, "limits", (low, high))
        for name in ("friction", "stiffness", "rest"):
            lowest = -np.inf if name == "rest" else 0
            size = number(getattr(self, name), f"{name} of the {label}", lowest=lowest)
            in_range(size, f"{name} of the {label}")
            object.__setattr__(self, name, size)
        if self.guide and self.kind not in GUIDED:
            raise InputError(
                f"the {label} has {' and '.join(self.guide)}",
                hint=f"only joints of the kinds {' and '.join(GUIDED)} may have them",
            )

    @property
    def guide(self) -> dict[str, Any]:
        """The limits, friction, stiffness and rest of the joint, without defaults."""
        given: dict[str, Any] = {} if self.limits is None else {"limits": list(self.limits)}
        if self.friction:
            given["friction"] = self.friction
        if self.stiffness:
            given |= {"stiffness": self.stiffness, "rest": self.rest}
        return given

    @property
    def free_axes(self) -> dict[str, list[list[float]]]:
        """The `slides` and `turns` of a general joint as lists; empty for another joint."""
        if self.kind != "general":
            return {}
        return {name: getattr(self, name).tolist() for name in FREE_AXES}

    def moved(self, point: Any, turn: Any, position: float = 0.0) -> Joint:
        """The joint with another point, and with its directions turned by a matrix (3, 3).

        `position`: position [rad] or [length unit] in the new pose, from which positions count.
        """
        places: dict[str, Any] = {"axis": None if self.axis is None else turn @ self.axis}
        places |= {name: getattr(self, name) @ np.asarray(turn).T for name in FREE_AXES}
        if self.limits is not None:
            places["limits"] = tuple(limit - position for limit in self.limits)
        if self.stiffness:
            places["rest"] = self.rest - position
        return dataclasses.replace(self, point=point, **places)

    def without(self, *names: str) -> Joint:
        """The joint without its "limits", "friction" or "stiffness"."""
        none: dict[str, Any] = {"limits": None, "friction": 0.0, "stiffness": 0.0}
        return dataclasses.replace(self, **{name: none[name] for name in names})

    def __repr__(self) -> str:
        places = {"point": self.point, "axis": self.axis, "limits": self.limits}
        words = [f", {k}={in_brackets(v)}" for k, v in places.items() if v is not None]
        words += [f", {k}={v:g}" for k, v in self.guide.items() if k != "limits"]
        words += [f", {k}={v}" for k, v in self.free_axes.items() if v]
        return f"Joint({self.parts}, {self.kind!r}{''.join(words)})"

    def require_planar(self) -> None:
        """Raise an InputError if the axis of the joint does not suit motion in the x-z plane.

        Raises
        ------
        InputError
            If a revolute joint does not turn about y, a prismatic joint slides out of the
            plane, or the axis of a cylindrical joint is neither along y nor in the plane.
        """
        if self.kind == "general":
            raise InputError(
                f"general joint of {' and '.join(map(repr, self.parts))} in a planar assembly",
                hint="give a revolute, prismatic or cylindrical joint",
            )
        if self.kind not in NEEDS_AXIS:
            return
        along_y = float(np.hypot(self.axis[0], self.axis[2])) <= PLANAR_AXIS
        in_plane = abs(float(self.axis[1])) <= PLANAR_AXIS
        fits = {"revolute": along_y, "prismatic": in_plane, "cylindrical": along_y or in_plane}
        if fits[self.kind]:
            return
        need = {
            "revolute": "turn about y: axis [0, 1, 0]",
            "prismatic": "slide in x-z: an axis with y = 0",
            "cylindrical": "have its axis along y, or with y = 0",
        }
        names = " and ".join(repr(name) for name in self.parts)
        raise InputError(
            f"{self.kind} joint of {names} has axis {self.axis.tolist()} in a planar assembly",
            hint=f"in a planar assembly it must {need[self.kind]}",
        )


class ListedJoint(Record):
    """A joint of two parts, or of a part and "ground", in an answer."""

    parts: tuple[str, str]
    """Names of the parts."""
    kind: JointKind
    """Kind of the joint."""
    why: OrAbsent[str] = None
    """Reason for a fastened joint."""
    limits: OrAbsent[tuple[float, float]] = None
    """Least and largest position [rad] or [length unit]."""
    friction: OrAbsent[float] = None
    """Largest friction [N x length unit] or [N]."""
    stiffness: OrAbsent[float] = None
    """Stiffness of the spring [N x length unit / rad] or [N / length unit]."""
    rest: OrAbsent[float] = None
    """Position without a force of the spring [rad] or [length unit]."""
