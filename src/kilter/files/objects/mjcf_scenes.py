"""Read MJCF files with MuJoCo; `kilter.files.scene_process` runs this in a separate process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from kilter.errors import InputError
from kilter.files.mjcf_survey import survey_mjcf
from kilter.files.objects.mujoco_snapshot import Snapshot, take_snapshot

__all__ = ["read_mjcf"]


def read_mjcf(path: Path, keyframe: str | None, set_limits: Callable[[int], None]) -> Snapshot:
    """Read an MJCF file (a scene for MuJoCo) as a snapshot of its model.

    Parameters
    ----------
    path : Path
    keyframe : str or None
        Name of the keyframe whose pose is used; default the first keyframe.
    set_limits : callable
        Called with the size of all files [bytes] before MuJoCo builds the scene.

    Raises
    ------
    InputError
        If MuJoCo is not installed or rejects the file, if the scene has too many elements, or if
        there is no such keyframe.
    """
    size = survey_mjcf(path)
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "MJCF files need MuJoCo, which is not installed", hint="pip install 'kilter[mujoco]'"
        ) from None
    set_limits(size)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        what = " ".join(str(error).split())[:200]
        raise InputError(f"MuJoCo rejects it: {what}", hint="correct the file") from None
    return take_snapshot(mujoco, model, None, keyframe)
