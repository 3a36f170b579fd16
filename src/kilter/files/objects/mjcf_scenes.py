"""Read MJCF files with MuJoCo, in the process of `kilter.files.robots.scene_process`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.objects.mujoco_snapshot import Snapshot, StateRows, take_snapshot
from kilter.files.robots.mjcf_survey import survey_mjcf

WORKSPACE, WORKSPACE_OF_ELEMENT = 100_000_000, 20_000
"""Memory that MuJoCo reserves for its computations, and in addition for each element [bytes]."""

ASSET_FOLDERS = ("meshdir", "texturedir")
"""Settings of a scene with folders of its assets."""


def read_mjcf(
    path: Path,
    keyframe: str | None,
    states: StateRows | None,
    allow_time: Callable[[int], None],
) -> Snapshot:
    """Read an MJCF file (a scene for MuJoCo) as a snapshot of its model.

    Arguments: `allow_time`: called with the size of all files [bytes] before MuJoCo builds the
    scene. Raises `InputError` as `compiled_mjcf`, if there is no such keyframe, or if states do not
    belong to the model.
    """
    mujoco, model, folders = compiled_mjcf(path, allow_time)
    snapshot = take_snapshot(mujoco, model, None, keyframe, states)
    snapshot.asset_folders = folders
    return snapshot


def compiled_mjcf(
    path: Path, allow_time: Callable[[int], None]
) -> tuple[Any, Any, tuple[str, str] | None]:
    """The package of MuJoCo, the model of an MJCF file, and the folders of its assets.

    Raises `InputError` if MuJoCo is not installed or rejects the file, or if the scene has too many
    elements.
    """
    survey = survey_mjcf(path)
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "MJCF files need MuJoCo, which is not installed", hint="pip install 'kilter[mujoco]'"
        ) from None
    allow_time(survey.size)
    try:
        return mujoco, *_compiled(mujoco, path, survey.elements)
    except ValueError as error:
        what = " ".join(str(error).split())[:200]
        raise InputError(f"MuJoCo rejects it: {what}", hint="correct the file") from None


def _compiled(mujoco: Any, path: Path, elements: int) -> tuple[Any, tuple[str, str] | None]:
    """The MuJoCo model of a file, with little memory for a simulation.

    Returns the folders of its meshes and textures, too; None if they are not known.
    """
    if path.suffix != ".xml":  # MuJoCo knows the format of a specification by this ending only
        return mujoco.MjModel.from_xml_path(str(path)), None
    scene = mujoco.MjSpec.from_file(str(path))
    # by default the memory grows with the square of the number of bodies
    scene.memory = WORKSPACE + WORKSPACE_OF_ELEMENT * elements
    compiler = getattr(scene, "compiler", scene)  # older versions keep them in the scene itself
    folders = [getattr(compiler, name, getattr(scene, name, "")) for name in ASSET_FOLDERS]
    return scene.compile(), (folders[0], folders[1])
