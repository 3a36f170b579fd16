"""Write poses for a simulator: into a copy of the user's MJCF file, as an array, or as a new scene.

`--keyframe NAME` with an output X.xml names the keyframe that gets the poses. An existing keyframe
is read, too.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kilter.cli.output import tell_warnings, write_whole

if TYPE_CHECKING:
    from collections.abc import Collection

    from kilter.assembly import Assembly
    from kilter.cli.asked import Asked


def source_of(asked: Asked) -> Path:
    """The file with the parts: that of a file of choices, or the file itself."""
    return asked.source or Path(asked.file)


def with_key(asked: Asked, output: Path | None) -> tuple[Asked, str | None]:
    """The request without a keyframe that does not exist yet, and the keyframe to write."""
    name = asked.reading.keyframe
    if name is None or output is None or output.suffix.lower() != ".xml":
        return asked, None
    from kilter.files.robots.mjcf_poses import is_mjcf_file, key_to_write

    if not is_mjcf_file(source_of(asked)):
        return asked, None
    if asked.reading.state is not None:  # the keyframe is only written
        return replace(asked, reading=replace(asked.reading, keyframe=None)), name
    there, key = key_to_write(source_of(asked), name)
    return replace(asked, reading=replace(asked.reading, keyframe=there)), key


def write_simulator_pose(
    settled: Assembly, lost: Collection[str], asked: Asked, output: Path, key: str | None
) -> str:
    """Write poses to X.xml or X.npy; return words about their place, empty for a new scene.

    Arguments: `lost`: parts without a pose at rest, which keep their drawn poses in a copy of the
    user's file; `key`: keyframe to write.
    """
    from kilter.files.robots.mjcf_poses import is_mjcf_file, write_mjcf_poses

    source = source_of(asked)
    if not is_mjcf_file(source):
        return _write_all(settled, output, asked)
    from kilter.files.objects.state_scenes import open_scene

    scene = open_scene(source, asked.reading.format_options)
    drawn = scene.assembly()
    poses = {part.name: part.pose for part in drawn.parts if part.name in lost}
    qpos = scene.positions(drawn, settled.with_poses(poses))
    if output.suffix.lower() == ".npy":
        from kilter.files.writing import write_array

        write_array(output, qpos[None])
        return "qpos of the scene"
    words = write_mjcf_poses(source, output, scene, qpos, key)
    if asked.reading.floor is not None:
        tell_warnings(
            [f"{output} is a copy of {source}, which has no floor: give it a plane"], asked.quiet
        )
    return words


def _write_all(settled: Assembly, output: Path, asked: Asked) -> str:
    """Write a new MJCF scene, or the poses of all parts, shape (N, 7)."""
    if output.suffix.lower() == ".npy":
        from kilter.files.writing import write_array

        rows = [[*part.pose.position, *part.pose.rotation] for part in settled.parts]
        write_array(output, np.array(rows))
        return "position and quaternion of each part"
    from kilter.files.robots.mjcf import hull_notes

    write_whole(output, settled.to_mjcf())
    tell_warnings(hull_notes(settled), asked.quiet)
    return ""
