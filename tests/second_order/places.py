"""Cases of second order that are turned, moved, scaled, renamed or put side by side."""

from collections.abc import Sequence

import numpy as np
from balance_cases import CASES, Case

from kilter import Assembly, Box, Feature, GivenContact, Part, Pose, Sphere


def case_of(number: str) -> Case:
    """The case of this number."""
    return next(case for case in CASES if case.number == number)


def pieces(
    assembly: Assembly, turn: Pose, factor: float, name: str
) -> tuple[list[Part], list[GivenContact]]:
    """Parts and contacts, turned, moved, scaled and renamed, with the map of points."""
    parts = [
        Part(
            name.format(part.name),
            Sphere(factor * part.shape.radius)
            if isinstance(part.shape, Sphere)
            else Box([factor] * 3),
            Pose(turn.apply(factor * part.pose.position[None])[0], turn.rotation),
            grounded=part.grounded,
            mass=part.given_mass,
        )
        for part in assembly.parts
    ]
    contacts = []
    for one in assembly.contacts:
        assert one.feature is not None
        features = [
            Feature(
                f.kind,
                None if f.along is None else turn.matrix @ f.along,
                f.curvature / factor if f.kind == "face" else f.curvature[0] / factor,
                None if f.point is None else turn.apply(factor * f.point[None])[0],
                None if f.axis is None else turn.matrix @ f.axis,
            )
            for f in one.feature
        ]
        names = tuple(name.format(part) for part in one.parts)
        points = turn.apply(factor * np.asarray(one.points))
        contacts.append(
            GivenContact(names, points, turn.matrix @ one.normal, feature=tuple(features))
        )
    return parts, contacts


def moved(assembly: Assembly, turn: Pose, factor: float) -> Assembly:
    """The assembly with gravity, turned, moved, scaled and renamed."""
    parts, contacts = pieces(assembly, turn, factor, "{}'s")
    made = Assembly(parts, contacts=contacts, detect=False)
    return made.with_down(turn.matrix @ np.array([0.0, 0, -1]))


def side_by_side(assemblies: Sequence[Assembly], apart: float = 50.0) -> Assembly:
    """Assemblies in a row, each turned about the vertical by a different angle."""
    parts: list[Part] = []
    contacts: list[GivenContact] = []
    for k, assembly in enumerate(assemblies):
        turn = Pose([apart * k, 0, 0], [np.cos(0.3 * k), 0, 0, np.sin(0.3 * k)])
        own, touching = pieces(assembly, turn, 1.0, f"{k}-{{}}")
        parts += own
        contacts += touching
    return Assembly(parts, contacts=contacts, detect=False)
