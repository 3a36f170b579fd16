"""The command `scene`: the state of each object of a scene."""

from __future__ import annotations

from dataclasses import dataclass, replace

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLDS, LOWER, SCENE
from kilter.cli.options import Require, asks
from kilter.cli.output import OTHER_FILES, Progress, require_answer_file, tell_written
from kilter.cli.resting import require_pose_form, write_pose
from kilter.values.declaration import option

__all__ = ["scene"]


@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """Options of `scene`."""

    require: str = Require()
    settle: bool = option(
        "--settle",
        "First repair the scene: floating objects fall to their contact, and clusters with "
        "faults settle. With -o, the repaired scene is written: X.usda (a layer over a USD "
        "file), X.kilter.json, X.xml (MJCF), X.glb.",
    )


@asks(searches=True, writes=tuple(OTHER_FILES))
def scene(asked: Asked, options: SceneOptions) -> int:
    """Report for each object of a scene whether it is at rest, floats, overlaps or falls.

    Objects that touch each other form a cluster, and each cluster is judged by itself. Held are the
    static bodies of the file, the parts of --ground, and the table of --floor.

    Exit code: 0 every object is at rest at the level of --require; 1 some objects float, overlap or
    fall; 3 some are at rest only at a lower level; 4 some are open.
    """
    from kilter.analysis.scene_states.object_states import scene as find

    output = asked.output if options.settle else None
    if not options.settle:
        require_answer_file(asked.output)
    if output is not None:
        require_pose_form(output, asked)
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        report = find(
            assembly,
            require=options.require,
            settle=options.settle,
            **asked.shared(find, contacts, progress),
        )
        if output is not None:
            write_pose(report, asked, output)
    if options.settle:
        asked = replace(asked, output=None)
    asked.tell(report.to_dict())
    tell_written(output, "repaired scene", asked.quiet)
    if report.faults:
        return SCENE["faults"]
    if any(entry.state == "open" for entry in report):
        return SCENE["open"]
    return HOLDS if report.at_rest else LOWER
