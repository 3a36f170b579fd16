"""Planks on tables and bases, whose places have closed forms."""

from kilter import Assembly, Box, Part, Pose


def overhang(length: float, weight: float, beyond: float) -> Assembly:
    """A plank that extends beyond the edge of a table at x = 0."""
    table = Part("table", Box([4, 1, 1]), Pose([-2, 0, -0.5]), grounded=True)
    middle = [beyond - length / 2, 0, 0.05]
    return Assembly([table, Part("plank", Box([length, 1, 0.1]), Pose(middle), mass=weight)])


def bridge(friction: float = 0.0) -> Assembly:
    """Two planks of 1 kg, each centred on a narrow held base at x = -0.4 and 0.4."""
    parts = []
    for k, x in enumerate((-0.4, 0.4)):
        parts += [
            Part(f"base-{k}", Box([0.1, 1, 1]), Pose([x, 0, -0.5]), grounded=True),
            Part(f"plank-{k}", Box([0.5, 1, 0.1]), Pose([x, 0, 0.05]), mass=1),
        ]
    return Assembly(parts, friction=friction)
