"""Random programs whose contacts fit badly: fits of 1e-9 to 1e-3 and masses from 1 to 1e6."""

import dataclasses

import numpy as np
from random_friction import random_assembly
from random_voronoi import random_voronoi

from kilter.arrays import across, unit_rows
from kilter.assembly import Assembly
from kilter.contact import contacts
from kilter.mechanics.program import Program, build_program
from kilter.scenes.pieces import moved

FIT = (1e-9, 1e-3)
"""Least and greatest error of a normal [rad], and of a point over the radius of a part [-]."""
HEAVIEST = 1e6
"""Greatest ratio of the masses of two parts [-]."""
FARTHEST = 1e5
"""Greatest distance of an assembly from the origin [length unit]."""


def random_fit(seed: int) -> Program:
    """The program without friction of a random assembly with errors of its contacts.

    In half of the programs the normal and the points of each patch have errors of a random size in
    `FIT`, log-uniform; the other programs are exact.
    The mass of each part is log-uniform in 1 to `HEAVIEST`. In two thirds of the programs
    some patches transmit any force, like an overlap. In two thirds the assembly is far from the
    origin. In a fifth some parts touch only each other.

    Parameters
    ----------
    seed : int
        The same seed gives the same program.
    """
    random = np.random.default_rng(seed)
    assembly = random_voronoi(seed) if random.random() < 0.3 else random_assembly(seed)[1]
    assembly = _with_masses(_turned(assembly, random), random)
    program = build_program(assembly, contacts(assembly)).frictionless
    return _with_errors(_with_joined_patches(_with_floating_parts(program, random), random), random)


def _turned(assembly: Assembly, random: np.random.Generator) -> Assembly:
    """The assembly at a random place; gravity keeps its direction relative to the parts."""
    if assembly.planar:
        assembly = dataclasses.replace(assembly, planar=False)
    far = FARTHEST ** random.random() * float(random.random() < 2 / 3)
    return moved(assembly, unit_rows(random.normal(size=4)), far * random.normal(size=3))


def _with_masses(assembly: Assembly, random: np.random.Generator) -> Assembly:
    masses = HEAVIEST ** random.uniform(0.0, 1.0, len(assembly.parts))
    parts = [
        dataclasses.replace(part, mass=float(mass), density=None)
        for part, mass in zip(assembly.parts, masses, strict=True)
    ]
    return dataclasses.replace(assembly, parts=parts)


def _with_floating_parts(program: Program, random: np.random.Generator) -> Program:
    """In a fifth of the programs, without the contacts of random free parts with other parts."""
    if random.random() >= 0.2:
        return program
    floats = np.append(program.free & (random.random(len(program.names)) < 0.7), False)
    return program.taking(floats[program.part_a] == floats[program.part_b])


def _with_joined_patches(program: Program, random: np.random.Generator) -> Program:
    """In two thirds of the programs, some patches transmit any force at their points."""
    if random.random() >= 2 / 3 or not len(program.source):
        return program
    joined = random.random(program.source.max() + 1) < random.random()
    count, rows = len(program.source), np.flatnonzero(joined[program.source])
    tangents = across(program.normal[rows])
    wider = program.taking(np.concatenate([np.arange(count), rows, rows]))
    normal = np.concatenate([program.normal, *tangents])
    return wider.with_rows(normal=normal, two_sided=joined[wider.source] | wider.two_sided)


def _with_errors(program: Program, random: np.random.Generator) -> Program:
    """The program with errors of its normals and points."""
    if not len(program.source):
        return program
    patches, rows = program.source.max() + 1, len(program.source)
    sizes = np.exp(random.uniform(*np.log(FIT), patches)) * (random.random() < 0.5)
    normals = sizes[:, None] * random.normal(size=(patches, 3))
    size = np.where(program.free, program.radius, np.inf)
    reach = np.minimum(size[program.part_a], size[program.part_b])
    points = (sizes[program.source] * reach)[:, None] * random.normal(size=(rows, 3))
    turned = unit_rows(program.normal + normals[program.source])
    return program.with_rows(normal=turned, point=program.point + points)
