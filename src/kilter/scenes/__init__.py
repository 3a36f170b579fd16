"""The library of scenes: one source for examples, tests, benchmarks and documents.

Each scene is a function of its parameters that returns an `Assembly`; the registry
`SCENES` lists those that `kilter example` offers, with the defaults that make their answer
known. `source` is the case or figure a scene comes from.

Examples
--------
>>> scene("tower").names[:2]
('base', 'cube-1')
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from kilter.errors import InputError

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["SCENES", "Answer", "Scene", "scene"]

Answer = Literal["stable", "potentially-stable", "unstable"]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A named scene.

    Parameters
    ----------
    name : str
        In kebab-case.
    title : str
        One line.
    build : callable
        Makes the assembly; the module it is in is imported then.
    source : str
        Case, figure or publication.
    answer : {"stable", "potentially-stable", "unstable"}
        The verdict. "potentially-stable": friction can hold it, but a motion obeys the contact
        law as well, or the proof that none does takes longer than the usual budget.
    """

    name: str
    title: str
    build: Callable[[], Assembly]
    source: str
    answer: Answer


def scene(name: str) -> Assembly:
    """The assembly of the scene of that name.

    Raises
    ------
    InputError
        If there is none; it names the nearest.

    Examples
    --------
    >>> scene("towr")
    Traceback (most recent call last):
    kilter.errors.InputError: no scene is named 'towr'; did you mean 'tower'?
    """
    if name not in SCENES:
        from kilter.errors import nearest_name

        near = nearest_name(name, SCENES)
        hint = f"did you mean {near!r}?" if near else f"there are: {', '.join(SCENES)}"
        raise InputError(f"no scene is named {name!r}", hint=hint)
    return SCENES[name].build()


def _scene(
    name: str, title: str, where: str, source: str, answer: Answer, **parameters: Any
) -> Scene:
    """A scene whose builder is `where`, "module.function", imported when it is called."""
    module, function = where.split(".")

    def build() -> Assembly:
        made = getattr(importlib.import_module(f"kilter.scenes.{module}"), function)(**parameters)
        assert not isinstance(made, list)
        result: Assembly = made
        return result

    return Scene(name, title, build, source, answer)


_ALL = (
    _scene(
        "paper-figure-1",
        "a block drives another out of a right-angled one",
        "paper.figure_1",
        "F1(a)",
        "unstable",
    ),
    _scene(
        "paper-figure-1-turned",
        "the same, turned by 45 degrees: it stays",
        "paper.figure_1",
        "F1(b)",
        "stable",
        orientation="b",
    ),
    _scene(
        "paper-figure-4",
        "the second of three directions of gravity: z = -2.5",
        "paper.figure_4",
        "F4",
        "unstable",
        orientation=2,
    ),
    _scene(
        "paper-figure-8",
        "C2 sinks by 1 and drives C3 aside by 1 / tan 60",
        "paper.figure_8",
        "F8",
        "unstable",
    ),
    _scene(
        "paper-figure-9",
        "four blocks in a frame: stable, yet free to circulate",
        "paper.figure_9",
        "F9",
        "stable",
        planar=True,
    ),
    _scene(
        "paper-figure-10",
        "two blocks in an L, tipped out of a whole range of stable directions",
        "paper.figure_10",
        "F10(a)",
        "unstable",
    ),
    _scene(
        "paper-figure-11",
        "two blocks chamfered 45 degrees in an L: one stable direction",
        "paper.figure_11",
        "F11(a)",
        "unstable",
    ),
    _scene(
        "paper-figure-11-turned",
        "the same at 45 degrees, its only stable orientation",
        "paper.figure_11",
        "F11(b)",
        "stable",
        orientation="b",
    ),
    _scene(
        "paper-figure-12",
        "two blocks chamfered 60 degrees in an L: one stable direction",
        "paper.figure_12",
        "F12(a)",
        "unstable",
    ),
    _scene(
        "paper-figure-12-turned",
        "the same leaning 60 degrees, its only stable orientation",
        "paper.figure_12",
        "F12(b)",
        "stable",
        orientation="b",
    ),
    _scene(
        "trapped-wedge",
        "a block under an overhang, gravity 10 degrees toward the wall",
        "paper.trapped_wedge",
        "TR",
        "stable",
    ),
    _scene("tower", "five cubes on a held one", "stacks.tower", "S2", "stable"),
    _scene(
        "staircase",
        "four cubes, each a little further out, just inside the limit",
        "stacks.staircase",
        "S3",
        "stable",
    ),
    _scene(
        "slope",
        "a block on a slope of 20 degrees without friction",
        "stacks.block_on_slope",
        "S8",
        "unstable",
    ),
    _scene(
        "slope-with-friction",
        "a block on a slope of 20 degrees, friction 0.5",
        "stacks.block_on_slope",
        "S1",
        "stable",
        friction=0.5,
    ),
    _scene(
        "wedge-on-wedge",
        "a wedge slides down a wedge that slides on the floor",
        "motion.wedge_on_wedge",
        "S8",
        "unstable",
    ),
    _scene(
        "harmonic-stack",
        "ten blocks that reach 1.46 lengths over an edge, just balanced",
        "stacks.harmonic_stack",
        "O1",
        "stable",
    ),
    _scene(
        "inverted-triangle",
        "rows of 1, 2 and 3 blocks, not balanced",
        "stacks.inverted_triangle",
        "O3",
        "unstable",
    ),
    _scene("diamond", "a diamond of 16 blocks on one, balanced", "stacks.diamond", "O4", "stable"),
    _scene("wall", "a running-bond wall", "walls.wall", "running bond", "stable"),
    _scene(
        "wall-with-opening",
        "a brick over the opening of a wall rests on nothing",
        "walls.wall_with_opening",
        "running bond",
        "unstable",
    ),
    _scene(
        "wall-with-lintel",
        "the same opening under a lintel",
        "walls.wall_with_lintel",
        "running bond",
        "stable",
    ),
    _scene(
        "wall-on-short-base",
        "a wall that is longer than its base",
        "walls.short_base",
        "running bond",
        "unstable",
    ),
    _scene(
        "hanging-brick",
        "one brick of a wall hangs in the air",
        "walls.hanging_brick",
        "running bond",
        "unstable",
    ),
    _scene(
        "tilted-wall",
        "a wall tilted 5 degrees out of its plane, friction 0.6",
        "walls.tilted_wall",
        "S7",
        "potentially-stable",
    ),
    _scene(
        "pierced-wall",
        "a wall with two openings, friction 0.65",
        "walls.ferris_tin_loi",
        "Ferris and Tin-Loi, wall 4",
        "stable",
        number=4,
    ),
    _scene("arch", "a semicircular arch of 20 voussoirs", "arches.arch", "A1", "stable"),
    _scene(
        "arch-with-held-ends",
        "a semicircular arch, its first and last voussoir held",
        "arches.arch_with_held_ends",
        "W6",
        "potentially-stable",
    ),
    _scene("keystone", "a keystone between two springers", "wedges.keystone", "wedge", "stable"),
    _scene(
        "corner-wedges",
        "a cube in a corner, cut into six wedges",
        "wedges.corner_wedges",
        "wedge",
        "stable",
    ),
    _scene("box-pile", "thirty boxes put down at random", "packings.box_pile", "pile", "stable"),
    _scene(
        "ladder", "a ladder on a wall, friction on the floor", "friction.ladder", "S4", "stable"
    ),
    _scene("bracket", "a bracket on a post", "friction.bracket", "S5", "potentially-stable"),
    _scene("books", "eight books pressed together", "friction.books", "S6", "potentially-stable"),
    _scene(
        "squeezed-block",
        "a block between two walls",
        "friction.h_block",
        "I1",
        "potentially-stable",
    ),
    _scene("trough", "a prism in a tilted trough", "friction.trough", "I3", "potentially-stable"),
    _scene(
        "three-cylinders",
        "a cylinder on two cylinders",
        "rounds.three_cylinders",
        "R1",
        "stable",
    ),
    _scene("laden-slab", "a slab that carries 125 cubes", "traps.laden_slab", "W7", "stable"),
    _scene(
        "floating-block",
        "one block of a row floats",
        "traps.floating_block",
        "W1",
        "unstable",
    ),
    _scene(
        "slot",
        "a block between two plates",
        "rails.railed",
        "region: line",
        "unstable",
        sides="-x +x",
    ),
    _scene(
        "channel",
        "a block in a channel",
        "rails.railed",
        "region: half-plane",
        "stable",
        sides="-x +x -z",
    ),
    _scene(
        "tube", "a block in a tube", "rails.railed", "region: plane", "stable", sides="-x +x -z +z"
    ),
    _scene("groove", "a prism in a V-groove", "rails.groove", "region: fan", "stable"),
    _scene(
        "stopped-groove",
        "a prism in a V-groove between two stops",
        "rails.groove",
        "region: wedge",
        "stable",
        ends=2,
    ),
    _scene(
        "pit",
        "a block in a pit",
        "rails.railed",
        "region: half-space",
        "stable",
        sides="-x +x -y +y -z",
    ),
    _scene(
        "closed-frame",
        "a block locked in a frame",
        "rails.railed",
        "region: all",
        "stable",
        sides="-x +x -y +y -z +z",
    ),
    _scene(
        "pit-wedges", "a cube in a pit, cut into six", "rails.pit_wedges", "region: cone", "stable"
    ),
)

SCENES: dict[str, Scene] = {entry.name: entry for entry in _ALL}
"""Every scene by name."""
