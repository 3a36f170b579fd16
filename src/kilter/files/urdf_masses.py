"""Mass, centre and inertia in the `inertial` elements of URDF links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.assembly.inertia import inertia_fault, inertia_matrix
from kilter.assembly.mass_properties import MassProperties
from kilter.errors import InputError
from kilter.files.urdf_elements import Element, numbers_of, origin_of
from kilter.rigid import Pose
from kilter.validate import number

__all__ = ["Inertial", "read_inertial"]

KEYS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
"""Attributes of an `inertia` element, in the order of `inertia_matrix`."""


@dataclass(frozen=True, slots=True, eq=False)
class Inertial:
    """Mass [kg], centre [m], and inertia about it [kg m^2] or None, in the frame of a link."""

    mass: float
    center: Array
    inertia: Array | None

    def placed(self, frame: Pose) -> MassProperties:
        """The mass properties in the world, without an inertia as those of a point mass."""
        inertia = np.zeros((3, 3)) if self.inertia is None else self.inertia
        return MassProperties(self.mass, self.center, inertia).outside(frame)


def read_inertial(link: Element, notes: list[str]) -> Inertial | None:
    """The mass, centre and inertia that a link states; None if it states no mass.

    A note is appended for a mass of zero, and for an inertia that no body has. An inertia of zeros
    counts as not stated.

    Raises `InputError` if a number is invalid or the mass is negative; the error names the link.
    """
    try:
        return _inertial(link, notes)
    except InputError as error:
        raise error.located(part=link.get("name")) from None


def _inertial(link: Element, notes: list[str]) -> Inertial | None:
    """The result of `read_inertial`; errors do not name the link."""
    inertial = link.find("inertial")
    element = None if inertial is None else inertial.find("mass")
    if inertial is None or element is None:
        return None
    mass = number(numbers_of(element, "value", 1, "0")[0], "mass", lowest=0)
    name = f"{link.get('name', '')!r:.80}"
    if mass == 0:
        notes.append(f"the mass of {name} is 0, so it has its density")
        return None
    frame = origin_of(inertial)
    tensor = inertial.find("inertia")
    own = inertia_matrix(np.array([numbers_of(tensor, key, 1, "0")[0] for key in KEYS]))
    fault = inertia_fault(own) if own.any() else ""
    if fault:
        notes.append(f"no body has the inertia of {name}, so that of its shape is used: {fault}")
    turned = frame.matrix @ own @ frame.matrix.T
    return Inertial(mass, frame.position, None if fault or not own.any() else turned)
