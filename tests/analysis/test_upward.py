"""The proposal of another upward axis, on both sides of each condition, and judged by `check`."""

from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Joint, Load, Part, Pose, contacts
from kilter.analysis.assumptions.joining import joined
from kilter.analysis.assumptions.upward import USUAL, better_up
from kilter.rigid import UP
from kilter.scenes.pieces import block
from kilter.shape.primitives import Sphere


def read(*parts: Part, **options: object) -> Assembly:
    """An assembly as from a file that does not state which axis points up."""
    return Assembly(parts, up_assumed=True, **options)


def proposal(assembly: Assembly) -> str | None:
    return better_up(assembly, contacts(assembly))


def holds(assembly: Assembly, up: str) -> bool:
    turned = assembly.with_down([-x for x in UP[up]]).with_floor()
    return kilter.check(joined(turned, contacts(turned)), effort=0).level is not None


def leaning(shift: float) -> Assembly:
    """A post with a beam on it that leans over in +x by its shift; two parts that touch."""
    post, beam = block("post", [-1, -1, 0], [1, 1, 2]), block("beam", [-1, -1, 2], [5, 1, 3])
    return read(post, replace(beam, pose=Pose(np.add(beam.pose.position, [shift, 0, 0]))))


@pytest.mark.parametrize(
    ("shift", "expected"), [(-1.0, None), (-1 / 3 - 0.01, None), (-1 / 3 + 0.01, "y"), (0.7, "y")]
)
def test_an_axis_is_proposed_only_if_the_drawn_axis_falls_when_joined(shift, expected):
    """Masses 8 and 12: the common centre leaves the post of half width 1 at a shift of -1/3."""
    assembly = leaning(shift)
    assert proposal(assembly) == expected
    assert holds(assembly, "z") is (expected is None)
    if expected is not None:
        assert expected == next(up for up in USUAL if holds(assembly, up))


def test_an_assembly_that_falls_as_drawn_but_stands_joined_keeps_its_axis():
    assembly = read(block("post", [0, 0, 0], [1, 1, 4]), block("arm", [1, 0, 3], [1.4, 1, 4]))
    assert kilter.check(assembly.with_floor(), effort=0).verdict == "unstable"
    assert proposal(assembly) is None


def test_a_loose_part_is_loose_with_every_axis():
    loose = block("loose", [2, 0, 5], [2.5, 0.5, 5.5])
    assert proposal(replace(leaning(0.0), parts=[*leaning(0.0).parts, loose])) is None
    # beside it on the floor of y up, but not on that of z up
    beside = block("beside", [9, -1, 1], [10, 0, 2])
    assert proposal(replace(leaning(0.0), parts=[*leaning(0.0).parts, beside])) == "y"


def test_a_body_at_its_limit_leaves_the_axis_undecided():
    assert proposal(leaning(-1 / 3)) is None
    assert proposal(read(Part("ball", Sphere(1.0)))) is None


def test_no_axis_is_proposed_if_it_is_stated_or_if_a_part_is_held():
    assembly = leaning(0.0)
    assert proposal(replace(assembly, up_assumed=False)) is None
    assert proposal(assembly.with_down([0, 0, -1])) is None
    assert proposal(assembly.with_grounded("post")) is None
    assert proposal(replace(assembly, joints=[Joint(("ground", "post"))])) is None
    assert proposal(replace(assembly, loads=[Load("post", force=[0, 0, -1])])) is None
    assert proposal(assembly.with_floor()) == "y"


@pytest.mark.parametrize(
    ("name", "options", "assumed"),
    [("a.obj", {}, True), ("a.obj", {"up": "z"}, False), ("a.obj", {"down": [0, 0, -1]}, False),
     ("a.kilter.json", {}, False)],
)  # fmt: skip
def test_the_reader_keeps_whether_the_axis_is_stated(tmp_path, name, options, assumed):
    box = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "a.obj").write_text(box)
    kilter.dump(leaning(0.0), tmp_path / "a.kilter.json")
    assembly = kilter.load(tmp_path / name, **options)
    assert assembly.up_assumed is assumed
    assert not any("up" in note for note in assembly.notes)
