"""A folder that somebody sent, opened in Chromium: a click changes no file outside of it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.workbench.history import autosave_path

pytestmark = pytest.mark.browser

STARTUP = "export EDITOR=vi\n"
COMMAND = "$(touch hit)"
"""A name that a shell would run, if it stood in its start file."""


@pytest.fixture
def startup(tmp_path: Path) -> Path:
    """A file that a shell runs at its start."""
    path = tmp_path / "profile"
    path.write_text(STARTUP)
    return path


def hostile() -> Assembly:
    base = Part("base", Box([2, 2, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([base, Part(COMMAND, Box([1, 1, 1]), Pose([1.2, 0, 0.5]))])


@pytest.mark.skipif(os.name != "posix", reason="links of POSIX")
def test_a_link_in_the_place_of_the_autosave_is_a_sentence(
    user: Callable, folder: Path, startup: Path
) -> None:
    page = user(hostile())
    autosave_path(folder / "file.kilter.json").symlink_to(startup)
    (folder / "file.choices.kilter.json").symlink_to(startup.with_name("gone"))
    page.choose(COMMAND).click("#do-hold")
    page.until("!document.getElementById('message').hidden")
    words = page.text("message-words")
    assert "not kept beside the file" in words
    assert "is a link, which is not followed" in words
    page.page.click("#save")
    page.until("!document.getElementById('trouble').hidden")
    refused = "ile.choices.kilter.json: is a link, which is not followed: remove it"
    assert page.text("trouble-words").endswith(refused)
    assert startup.read_text() == STARTUP
    assert os.listdir(startup.parent) == [startup.name]
    # without the links, the same clicks keep and save the choices
    autosave_path(folder / "file.kilter.json").unlink()
    (folder / "file.choices.kilter.json").unlink()
    page.click("#undo")
    page.choose(COMMAND).click("#do-hold")
    page.page.click("#save")
    page.until("!window.bench.session.dirty")
    saved = kilter.load(folder / "file.choices.kilter.json")
    assert [part.grounded for part in saved.parts] == [True, True]


def test_a_mesh_outside_of_the_folder_names_the_folder_to_open(
    user: Callable, folder: Path, tmp_path: Path
) -> None:
    page = user(None)
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\n")
    (folder / "robot.urdf").write_text(
        '<robot name="r"><link name="a"><collision><geometry>'
        f'<mesh filename="file://{tmp_path / "mesh.obj"}"/></geometry></collision></link></robot>'
    )
    page.page.reload()
    page.begin().page.click("#listed button:has-text('robot.urdf')")
    page.until("!document.getElementById('trouble').hidden")
    above = os.path.commonpath([os.path.realpath(folder), os.path.realpath(tmp_path)])
    assert "outside of the opened folder" in page.text("trouble-words")
    assert f"--folder {above}" in page.text("trouble-words")
