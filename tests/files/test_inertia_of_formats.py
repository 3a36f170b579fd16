"""Given inertia counts in kilter's own file, in URDF and in USD: three bodies by closed forms."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.cli import main

G = 9.81
FORMATS = ["kilter", "urdf", "usd"]


def written(
    folder: Path, kind: str, size: Any, at: Any, mass: float, moments: Any, mu: float = 0.0
) -> Path:
    """A box with principal moments about its middle, on the half space x, z < 0 that is held."""
    table, below = [4.0, 4.0, 1.0], [-2.0, 0.0, -0.5]
    if kind == "kilter":
        parts = [
            kilter.Part("table", kilter.Box(table), below, grounded=True),
            kilter.Part("body", kilter.Box(size), at, mass=mass, inertia=[*moments, 0, 0, 0]),
        ]
        path = folder / "a.kilter.json"
        kilter.dump(kilter.Assembly(parts, friction=mu), path)
        return path
    if kind == "urdf":
        six = dict(zip(("ixx", "iyy", "izz"), moments, strict=True))
        tensor = " ".join(f'{key}="{value:.17g}"' for key, value in six.items())
        inertial = f'<inertial><mass value="{mass}"/><inertia {tensor}/></inertial>'
        links = "".join(
            f'<link name="{name}">{inner}<collision><origin xyz="{place}"/><geometry>'
            f'<box size="{" ".join(map(str, box))}"/></geometry></collision></link>'
            for name, inner, place, box in (
                ("table", "", " ".join(map(str, below)), table),
                ("body", inertial, "0 0 0", size),
            )
        )
        joint = '<joint name="j" type="floating"><parent link="table"/><child link="body"/>'
        joint += f'<origin xyz="{" ".join(map(str, at))}"/></joint>'
        path = folder / "a.urdf"
        path.write_text(f"<robot>{links}{joint}</robot>")
        return path
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
    from pxr import Gf, UsdPhysics
    from usd_maker import Stage

    path = folder / "a.usda"
    stage = Stage(path)
    stage.box("table", below, table, static=True)
    body = stage.box("body", at, size, mass=mass)
    values = UsdPhysics.MassAPI(stage.stage.GetPrimAtPath(body))
    # the axes of the moments are z, x, y of the body
    values.CreateDiagonalInertiaAttr(Gf.Vec3f(moments[2], moments[0], moments[1]))
    values.CreatePrincipalAxesAttr(Gf.Quatf(0.5, -0.5, -0.5, -0.5))
    stage.save()
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kind", FORMATS)
def test_a_heavy_rim_does_not_turn_with_its_carrier(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """3 kg m2 need 24 N m at 8 rad/s2; mu m g r gives at most 8.3 with all weight at corners."""
    path = written(tmp_path, kind, [0.4, 0.4, 0.1], [-2, 0, 0.05], 10.0, [1.6, 1.6, 3.0])
    words = ["--turn-faster", "0", "0", "8", "--about", "-2", "0", "0", "--friction", "0.3"]
    assert main(["transport", str(path), *words, "--json"]) == 1
    case = json.loads(capsys.readouterr().out)["cases"][0]
    assert case["factor"] == pytest.approx(0.3 * 10 * G * 0.2 * np.sqrt(2) / 24, rel=1e-6)
    assert case["factor"] <= 0.35


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize(
    ("size", "beyond", "mass", "inertia", "expected"),
    [
        ([1.0, 1.0, 0.2], 0.2, 10.0, 0.05, 43.6),
        ([1.0, 1.0, 0.2], 0.2, 10.0, 5.0, 3.63),
        ([2.0, 0.25, 0.25], 0.45, 1.0, 1.0 + 0.25**2 / 6, 3.64),
    ],
    ids=["light-plate", "heavy-plate", "bar-with-heavy-ends"],
)
def test_a_body_tips_over_an_edge_as_its_inertia_states(
    kind: str,
    size: Any,
    beyond: float,
    mass: float,
    inertia: float,
    expected: float,
    tmp_path: Path,
) -> None:
    """The acceleration is m g d / (I + m d^2), with the centre d beyond the edge."""
    moments = [0.9 * inertia, inertia, inertia]
    path = written(tmp_path, kind, size, [beyond, 0, size[2] / 2], mass, moments)
    verdict = kilter.check(kilter.load(path))
    row = verdict.assembly.index_of("body")
    found = verdict.motion.acceleration[row, 4]
    assert found == pytest.approx(mass * G * beyond / (inertia + mass * beyond**2), rel=1e-6)
    assert found == pytest.approx(expected, abs=0.05)
