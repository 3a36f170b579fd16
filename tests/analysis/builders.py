"""Small assemblies with loads, joints and given contacts that several tests start from."""

import numpy as np

from kilter import AssemblyArrays
from kilter.arrays import starts
from kilter.assembly import Assembly, GivenContact, Joint, Load
from kilter.scenes import stacks
from kilter.scenes.pieces import block, floor
from kilter.shape.primitives import surface


def pressed_box() -> Assembly:
    """A box on a floor, pressed down off its middle and twisted: it stays."""
    parts = [floor([-2, -2], [4, 2]), block("box", [0, -0.5, 0], [1, 0.5, 1])]
    loads = [
        Load("box", force=[0, 0, -500.0], point=[0.7, 0.1, 1.0]),
        Load("box", torque=[30.0, -20.0, 0.0]),
    ]
    return Assembly(parts, loads=loads)


def toppled_box() -> Assembly:
    """A box on a floor that a load and a torque turn over."""
    parts = [floor([-2, -2], [4, 2]), block("box", [0, -0.5, 0], [1, 0.5, 1])]
    loads = [Load("box", force=[0.0, 0.0, -6e3], point=[-0.2, 0.1, 1.0], torque=[1.0, -7e3, 0.0])]
    return Assembly(parts, loads=loads, friction=0.0)


def hanging_pair() -> Assembly:
    """One part hangs on another that stands, and one on the ground: fixed joints."""
    parts = [
        floor([-2, -2], [2, 2]),
        block("post", [-1, -1, 0], [1, 1, 2]),
        block("arm", [1.5, -0.2, 1], [1.8, 0.2, 1.2]),
        block("lamp", [3, 0, 3], [4, 1, 4]),
    ]
    joints = [
        Joint(("post", "arm"), point=[1.2, 0.1, 1.1]),
        Joint(("ground", "lamp"), point=[3, 0, 5], axis=[0, 0, 1]),
    ]
    return Assembly(parts, joints=joints)


def falling_pair() -> Assembly:
    """A post that the heavy arm joined to it pulls over."""
    parts = [
        floor([-2, -2], [2, 2]),
        block("post", [1.2, -0.4, 0], [2.2, 0.4, 2], density=1000.0),
        block("arm", [2.5, -0.2, 1], [4.8, 0.2, 1.2], density=9000.0),
    ]
    return Assembly(parts, joints=[Joint(("post", "arm"), point=[2.4, 0.1, 1.1])])


def rough_staircase() -> Assembly:
    """Two cubes, with friction that is not needed."""
    return stacks.staircase(2).with_friction(0.3)


def given() -> Assembly:
    """A box on three given points, in cm, nothing detected."""
    parts = [floor([-2, -2], [2, 2]), block("box", [-0.5, -0.5, 0.2], [0.5, 0.5, 1])]
    feet = [[-0.4, -0.4, 0.1], [0.4, -0.4, 0.1], [0.0, 0.4, 0.1]]
    contact = GivenContact(("floor", "box"), feet, [0.0, 0.0, 1.0], mu=0.2)
    return Assembly(parts, contacts=[contact], detect=False, units="cm")


def arrays_of(assemblies: list[Assembly], **more: object) -> AssemblyArrays:
    """The assemblies as arrays of meshes."""
    parts = [part for one in assemblies for part in one.parts]
    surfaces = [surface(part.shape) for part in parts]
    first = starts([len(vertices) for vertices, _ in surfaces])
    given = {
        "vertices": np.concatenate(
            [part.pose.apply(v) for part, (v, _) in zip(parts, surfaces, strict=True)]
        ),
        "faces": np.concatenate(
            [faces + k for (_, faces), k in zip(surfaces, first[:-1], strict=True)]
        ),
        "vertex_start": first,
        "face_start": starts([len(faces) for _, faces in surfaces]),
        "part_start": starts([len(one) for one in assemblies]),
        "held": [part.grounded for part in parts],
        "gravity": np.array([one.gravity for one in assemblies]),
    }
    return AssemblyArrays(**{**given, **more})
