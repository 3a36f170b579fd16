"""A tower of three blocks: a small gap is below the upper block."""

from kilter import Assembly, Box, Part, Pose

__all__ = ["tower"]


def tower() -> Assembly:
    """Blocks a, b and c above each other; a gap of 0.01 is below c, which is 0.2 off the middle."""
    a = Part("a", Box([2, 2, 1]), Pose([0, 0, 0.5]))
    b = Part("b", Box([1, 1, 1]), Pose([0, 0, 1.5]))
    c = Part("c", Box([1, 1, 1]), Pose([0.2, 0, 2.51]))
    return Assembly([a, b, c])
