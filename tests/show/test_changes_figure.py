"""The figure of changes that help: arrows where a limit gains, the changed assembly beside."""

from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.analysis.margins.best_movements import best_forces, best_movements
from kilter.cli import main
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes import arches

pytest.importorskip("matplotlib")


def tower() -> Assembly:
    table = Part("table", Box(3, 2, 0.3), [0.3, 0, -0.15], grounded=True)
    low = Part("low", Box(1, 1, 1), [0, 0, 0.5])
    high = Part("high", Box(1, 1, 1), [0.3, 0.1, 1.5])
    top = Part("top", Box(1.2, 0.6, 0.5), [0.4, 0.1, 2.25])
    return Assembly([table, low, high, top], friction=0.7)


def test_arrows_point_where_the_limit_gains():
    """A step along an arrow gains as much as the arrow says, by the limit of the moved tower."""
    given = tower()
    answer = kilter.margin(given, effort=0)
    gains = best_movements(given, answer.contacts, answer.gradient())
    assert not gains[0].any()  # the table is held
    assert gains[1][0] > 0 > gains[2][0]
    assert not gains[:, 2].any()  # along the contacts only
    step = 1e-5
    for k in (1, 2, 3):
        size = float(np.linalg.norm(gains[k]))
        position = np.asarray(given[k].pose.position) + step * gains[k] / size
        moved = kilter.margin(given.with_pose(k, Pose(position)), effort=0)
        assert (moved.tilt_deg - answer.tilt_deg) / step == pytest.approx(size, rel=1e-3)


def test_parts_that_cannot_slide_have_arrows_of_forces():
    arch = arches.arch()
    answer = kilter.margin(arch, effort=0)
    gradient = answer.gradient()
    assert not best_movements(arch, answer.contacts, gradient).any()
    forces = best_forces(arch, gradient)
    crown = int(np.argmax(arch.geometry.center[:, 2]))
    assert forces[crown][2] > 0  # it hangs less on its neighbours
    assert not forces[arch.geometry.grounded].any()


@pytest.mark.slow
def test_the_figure_shows_both_assemblies_and_the_change(tmp_path, capsys):
    answer = kilter.margin(tower(), improve=True)
    figure = kilter.draw(answer)
    words = [text.get_text() for text in figure.findobj() if hasattr(text, "get_text")]
    assert {"as given", "changed"} <= set(words)
    assert any("movement that raises the tilt" in each for each in words)
    heads = answer.improvements[0].sentence[1:20]
    assert any(heads in each for each in words)
    path = tmp_path / "tower.kilter.json"
    kilter.dump(tower(), path)
    assert main(["draw", str(path), "--what", "changes", "-o", str(tmp_path / "a.svg")]) == 0
    assert Path(tmp_path / "a.svg").stat().st_size > 1000
    capsys.readouterr()


def test_an_assembly_without_changes_and_gradient_is_an_error():
    bonded = kilter.load(Path(__file__).parents[2] / "examples" / "mortared-corbel.kilter.json")
    with pytest.raises(InputError, match="derivatives are not computed for bonds"):
        kilter.draw(bonded, what="changes")
