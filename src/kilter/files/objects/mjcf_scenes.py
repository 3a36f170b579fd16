"""Read MJCF files with MuJoCo; `kilter.files.scene_process` runs this in a separate process."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.mjcf_survey import survey_mjcf
from kilter.files.objects.mujoco_objects import ModelScene

__all__ = ["read_mjcf"]


def read_mjcf(
    path: Path, shown: str, choices: FormatOptions, set_limits: Callable[[int], None]
) -> Assembly:
    """Read an MJCF file (a scene for MuJoCo) as an assembly.

    Parameters
    ----------
    path : Path
    shown : str
        Name of the file for the assembly and for messages.
    choices : FormatOptions
        The options `units` and `keyframe`.
    set_limits : callable
        Called with the size of all files [bytes] before MuJoCo builds the scene.

    Raises
    ------
    InputError
        If MuJoCo is not installed or rejects the file, or if the scene has too many elements, no
        bodies, or geoms or joints that kilter does not support.
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
    return ModelScene(mujoco, model, None, choices).assembly(shown)
