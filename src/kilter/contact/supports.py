"""Supports: grips, fingers, props and magnets that may hold a part; supports as contacts.

A support at the point x of a part pushes it along the unit vector n by f n with f >= 0, and across
n by friction, |f_t| <= mu f:

    finger          from outside
    prop            upwards unless a direction is given, from outside or from another part,
                    which then carries it
    vacuum, magnet  as a finger; in addition it pulls with up to F, so that
                    f >= -F,  |f_t| <= mu (f + F)
    grip            holds the part: it does not move at all

With f' = f + F a vacuum or magnet is a contact with the force f' and a load -F n. So supports are
contact points and loads, and every analysis of contacts applies to supports. A support from outside
presses against a held part that stands for the outside world.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, starts
from kilter.assembly import Assembly, Load, Part
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import SUPPORT_BESIDE
from kilter.errors import InputError, nearest_name
from kilter.rigid import Pose, unit
from kilter.shape.primitives import Box
from kilter.validate import finite, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

KINDS = ("grip", "finger", "prop", "vacuum", "magnet")
PULLING = ("vacuum", "magnet")
"""Kinds that also pull, up to their capacity."""
OUTSIDE = "outside"
"""Name of the held part that stands for the outside world."""


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Support(Value):
    """A device that may hold a part, such as a finger, a prop, a vacuum cup or a magnet.

    Attributes
    ----------
    kind : {"grip", "finger", "prop", "vacuum", "magnet"}
    part : str
    point : ndarray, shape (3,), or None
        Point of action [length unit]; None for a grip.
    direction : ndarray, shape (3,), or None
        Unit vector along which it pushes the part. None: upwards for a prop; a grip has none.
    mu : float
        Friction coefficient across that direction [-].
    capacity : float
        Largest pull of a vacuum or magnet [N].
    on : str or None
        The part that a prop stands on; None: the ground.
    name : str
        Name; by default composed of the kind and the part.

    Raises
    ------
    InputError
        If the kind does not exist, or a value is missing or does not belong to the kind.

    Examples
    --------
    >>> Support("finger", "cube-1", [0, 0, 1], [0, 0, -1])
    <Support: finger on cube-1>
    """

    kind: str
    part: str
    point: Any = None
    direction: Any = None
    mu: float = 0.0
    capacity: float = 0.0
    on: str | None = None
    name: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"the kind of support {self.kind!r:.40} is unknown", hint=f"give {', '.join(KINDS)}"
            )
        label = f"{self.kind} on {self.part!r:.60}"
        if not isinstance(self.part, str):
            raise InputError(f"{label}: the part is no name", hint="give its name")
        set_field = object.__setattr__
        set_field(self, "name", self.name or f"{self.kind} on {self.part}")
        set_field(self, "mu", number(self.mu, f"{label}: mu", lowest=0))
        set_field(self, "capacity", number(self.capacity, f"{label}: capacity", lowest=0))
        self._require_fitting(label)
        if self.point is not None:
            set_field(self, "point", finite(self.point, (3,), f"{label}: point"))
        if self.direction is not None:
            set_field(self, "direction", unit(finite(self.direction, (3,), f"{label}: direction")))

    def _require_fitting(self, label: str) -> None:
        """Raise an InputError if the values do not suit the kind of support; `label` begins it."""
        if self.kind == "grip":
            if self.point is not None or self.direction is not None or self.mu:
                raise InputError(
                    f"{label}: a point, a direction or mu is given",
                    hint="leave them out: a grip holds the whole part",
                )
        elif self.point is None:
            raise InputError(f"{label}: the point is missing", hint="give the point of action")
        elif self.direction is None and self.kind != "prop":
            raise InputError(
                f"{label}: the direction is missing", hint="give the direction of its push"
            )
        if (self.capacity > 0) != (self.kind in PULLING):
            word = "is missing" if self.kind in PULLING else "is not allowed"
            raise InputError(
                f"{label}: a capacity {word}",
                hint="only a vacuum or magnet has a capacity, and it needs one",
            )
        if self.on is not None and (self.kind != "prop" or self.on == self.part):
            raise InputError(
                f"{label}: it stands on {self.on!r:.60}", hint="a prop stands on a part"
            )

    @classmethod
    def from_dict(cls, data: Any) -> Support:
        """Build a support from JSON data; the keys are the attributes.

        Raises
        ------
        InputError
            If a key is unknown or missing, or a value is invalid.
        """
        keys = [field.name for field in dataclasses.fields(cls)]
        if not isinstance(data, Mapping) or not {"kind", "part"} <= set(data):
            raise InputError(f"a support is {data!r:.60}", hint="give its kind and its part")
        for key in data:
            if key not in keys:
                near = nearest_name(key, keys)
                hint = f"did you mean {near!r}?" if near else f"there are: {', '.join(keys)}"
                raise InputError(f"a support has the unknown key {key!r:.40}", hint=hint)
        return cls(**data)

    def to_dict(self) -> dict[str, Any]:
        """JSON data of the support."""
        return {
            "kind": self.kind,
            "part": self.part,
            "point": None if self.point is None else self.point.tolist(),
            "direction": None if self.direction is None else self.direction.tolist(),
            "mu": self.mu,
            "capacity": self.capacity,
            "on": self.on,
            "name": self.name,
        }

    def pushing(self, assembly: Assembly) -> Array:
        """Unit vector along which the support pushes the part; by default upwards."""
        along: Array = -assembly.down if self.direction is None else self.direction
        return along

    def require_of(self, assembly: Assembly) -> None:
        """Raise an InputError if the support names an unknown or held part, or is not on the part.

        Raises
        ------
        InputError
            If the part does not exist or is held; if the point is not on the part.
        """
        k = assembly.index_of(self.part)
        if assembly[k].grounded:
            raise InputError("the part is held already: a support has no effect", part=self.part)
        if self.on is not None:
            assembly.index_of(self.on)
        if self.point is None:
            return
        low, high = (corner[k] for corner in assembly.geometry.part_boxes)
        reach = SUPPORT_BESIDE * float(assembly.geometry.size[k])
        if (self.point < low - reach).any() or (self.point > high + reach).any():
            raise InputError(
                f"the {self.kind} at {self.point.tolist()} is not on the part",
                part=self.part,
                hint="give a point of the part's surface, in the world frame",
            )
        if assembly.planar and self.pushing(assembly)[1]:
            raise InputError(
                f"the {self.kind} leaves the x-z plane of a planar assembly", part=self.part
            )

    def __repr__(self) -> str:
        return f"<Support: {self.kind} on {self.part}>"


def with_supports(
    assembly: Assembly, contacts: ContactSet, supports: Sequence[Support]
) -> tuple[Assembly, ContactSet]:
    """The assembly and its contacts with supports added as contact points; grips are rejected.

    The supports are the last patches, with a single point each, in their order.
    """
    name = OUTSIDE
    while name in assembly.index:
        name += "_"
    middle, size = assembly.geometry.center.mean(axis=0), float(assembly.geometry.size.max())
    # the outside world is a held box; its size does not matter for the mechanics
    outside = Part(name, Box([size, size, size]), Pose(middle), grounded=True, density=1.0)
    free = {part.name for part in assembly if not part.grounded}
    loads = [
        Load(s.part, point=s.point, force=-s.capacity * s.pushing(assembly))
        for s in supports
        if s.capacity and s.part in free
    ]
    loaded = dataclasses.replace(
        assembly, parts=[*assembly.parts, outside], loads=[*assembly.loads, *loads]
    )
    return loaded, _with_support_points(contacts.of(loaded), supports, name)


def _with_support_points(
    contacts: ContactSet, supports: Sequence[Support], outside: str
) -> ContactSet:
    """The contacts with a patch of a single point added for each support."""
    assembly, count = contacts.assembly, len(supports)
    parts = [(assembly.index_of(s.on or outside), assembly.index_of(s.part)) for s in supports]
    points = np.array([s.point for s in supports], dtype=float).reshape(-1, 3)
    normals = np.array([s.pushing(assembly) for s in supports]).reshape(-1, 3)
    none = np.zeros(count)
    lengths = np.append(np.diff(contacts.patch_start), np.ones(count, dtype=np.int64))
    more: dict[str, Any] = {
        "patch_parts": np.array(parts, dtype=np.int64).reshape(-1, 2),
        "patch_normal": normals,
        "patch_area": none,
        "patch_gap": np.zeros((count, 2)),
        "patch_mu": np.array([s.mu for s in supports], dtype=float),
        "patch_kind": np.full(count, "given"),
        "patch_accuracy": none,
        "patch_doubt": none,
        "patch_pieces": np.full((count, 2), -1),
        "points": points,
        "normals": normals,
    }
    joined: dict[str, Any] = {
        key: np.concatenate([getattr(contacts, key), rows]) for key, rows in more.items()
    }
    return dataclasses.replace(contacts, patch_start=starts(lengths), **joined)
