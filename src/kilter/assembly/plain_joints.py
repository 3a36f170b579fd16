"""Joints without friction and springs, for functions whose answers do not count them.

The strength of both does not grow with gravity. So the directions that hold form no cone, and the
searches of `plan`, `hold` and `place` do not solve programs with limited forces. `settle` moves the
parts, and leaves out the limits, too.
"""

from __future__ import annotations

import dataclasses

from kilter.assembly.assembly import Assembly
from kilter.errors import InputError

__all__ = ["plain_joints", "require_plain_joints"]

STRENGTH = ("friction", "stiffness")
"""Members of a joint whose forces do not grow with gravity."""
LEFT_OUT = {
    **dict.fromkeys(("region", "common_region", "orient", "plan", "states", "hold"), STRENGTH),
    **dict.fromkeys(("lashing", "place"), STRENGTH),
    "settle": (*STRENGTH, "limits"),
}
"""Members of joints that a function leaves out, by its name or by the kind of its proofs."""
WORDS = {"friction": "friction", "stiffness": "springs", "limits": "limits"}
"""Word of each member in a note."""


def plain_joints(assembly: Assembly, verb: str) -> Assembly:
    """The assembly without the members of joints that `verb` leaves out, and with a note of it.

    Examples
    --------
    >>> from kilter import Box, Joint, Part
    >>> rail = Joint(("lid", "ground"), "prismatic", axis=[1, 0, 0], limits=[0, 1], friction=2)
    >>> plain_joints(Assembly([Part("lid", Box(1, 1, 1))], joints=[rail]), "region").notes
    ('region leaves out the friction of 1 joint',)
    """
    names = LEFT_OUT.get(verb, ())
    odd = [bool(set(names) & set(joint.guide)) for joint in assembly.joints]
    if not any(odd):
        return assembly
    given = {name for joint in assembly.joints for name in names if name in joint.guide}
    *most, last = (WORDS[name] for name in names if name in given)
    words = " and ".join(filter(None, [", ".join(most), last]))
    count = f"{sum(odd)} joint{'s' if sum(odd) > 1 else ''}"
    joints = [joint.without(*names) for joint in assembly.joints]
    note = f"{verb} leaves out the {words} of {count}"
    return dataclasses.replace(assembly, joints=joints, notes=[*assembly.notes, note])


def require_plain_joints(assembly: Assembly, what: str) -> None:
    """Raise an InputError if a joint has friction or a spring, for a margin without them.

    Raises `InputError` if there is such a joint.
    """
    for joint in assembly.joints:
        if set(STRENGTH) & set(joint.guide):
            names = " and ".join(repr(name) for name in joint.parts)
            raise InputError(
                f"{what} does not support friction and springs of joints, such as that of {names}: "
                "they do not grow with gravity",
                file=assembly.source or None,
                hint="remove them, or leave this margin out",
            )
