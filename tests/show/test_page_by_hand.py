"""Numbers of a page, of its text and of its data, in millimetres, against closed forms."""

from __future__ import annotations

import json
import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose, Prism
from kilter.analysis.everything import everything
from kilter.scenes.pieces import block
from kilter.show.packing import unpack
from kilter.show.page import render

G = 9.81
TABLE = block("table", [-3000, -1000, -1000], [0, 1000, 0], grounded=True)


class Cells(HTMLParser):
    """The terms of lists with their values, and the rows of tables, as text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.within = False
        self.feed(re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S))

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag in ("tr", "dt"):
            self.rows.append([])
        if tag in ("td", "th", "dt", "dd"):
            self.rows[-1].append("")
            self.within = True

    def handle_endtag(self, tag: str) -> None:
        self.within = self.within and tag not in ("td", "th", "dt", "dd")

    def handle_data(self, data: str) -> None:
        if self.within:
            self.rows[-1][-1] += data.strip()


def paged(assembly: Assembly) -> tuple[list[list[str]], dict]:
    """Rows of the text of a page, and its data."""
    page = render(everything(assembly, margins=True), "page")
    [data] = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page, re.S)
    return Cells(page).rows, json.loads(data)


def row_of(rows: list[list[str]], *first: str, length: int) -> list[str]:
    [found] = [row for row in rows if row[: len(first)] == list(first) and len(row) == length]
    return found[len(first) :]


def numbers(text: str) -> list[float]:
    return [float(one) for one in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


@pytest.mark.slow
def test_a_beam_on_two_ridges() -> None:
    """Ridges at x = -1000 and 2000, and a beam of 100 kg with its centre at x = 300."""
    triangle = [[-100, -100], [100, -100], [0, 0]]
    left, right = (
        Part(name, Prism(triangle, 400.0), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", -1000), ("right", 2000))
    )
    beam = Part("beam", Box([5000, 200, 200]), [300, 0, 100], density=500.0)
    rows, data = paged(Assembly([left, right, beam], units="mm", friction=0.4))
    shares = {"left": 1700 / 3000, "right": 1300 / 3000}
    for name, x in (("left", -1000), ("right", 2000)):
        force, direction, at, _ = row_of(rows, name, "beam", length=6)
        assert force.endswith(" N")
        assert numbers(force) == [pytest.approx(shares[name] * 100 * G, rel=1e-3)]
        assert (numbers(direction), numbers(at)) == ([0, 0, 1], [x, 0, 0])
        words = row_of(rows, name, "beam", length=8)
        assert words == ["edge-face", "0", "0", "(0, 0, 1)", "0.4", "2"]
    state, _, mass, centre = row_of(rows, "beam", length=5)
    assert (state, mass, numbers(centre)) == ("stays", "100", [300, 0, 100])
    # the shortest push across the cone of friction, and the angle of friction
    push = numbers(row_of(rows, "weakest push", length=2)[0])
    angle = math.atan(0.4)
    assert push[0] == pytest.approx(100 * G * math.sin(angle), rel=1e-3)
    assert numbers(row_of(rows, "tilt", length=2)[0])[0] == pytest.approx(
        math.degrees(angle), rel=1e-5
    )
    assert numbers(row_of(rows, "mass", length=2)[0]) == [100]
    # forces of the picture, on the beam
    center = np.array(data["center"])
    given = data["given"]["forces"]
    points = unpack(given["points"]).reshape(-1, 3) + center
    forces = unpack(given["forces"]).reshape(-1, 3)
    for name, x in (("left", -1000), ("right", 2000)):
        here = np.abs(points[:, 0] - x) < 1
        assert forces[here].sum(axis=0) == pytest.approx([0, 0, shares[name] * 100 * G], abs=1e-3)
    assert unpack(data["parts"]["mass"])[2] == pytest.approx(100)
    # the box of the view: the beam, and the ridges below it
    assert data["extent"] == pytest.approx([2500, 200, 150])
    assert (data["gravity"], data["units"]) == (G, "mm")


@pytest.mark.slow
def test_a_cube_past_an_edge_and_a_load() -> None:
    """It turns about the edge 100 mm beside its centre: the motion is in mm/s^2, the load in N."""
    past = block("past", [-400, -500, 0], [600, 500, 1000], density=500.0)
    rows, data = paged(Assembly([TABLE, past], units="mm"))
    turn = G * 0.1 / (1 / 6 + 0.1**2)
    state, motion, mass, centre = row_of(rows, "past", length=5)
    assert (state, mass, numbers(centre)) == ("moves", "500", [100, 0, 500])
    assert numbers(motion)[3] == pytest.approx(turn, rel=1e-3)
    assert numbers(motion)[-1] == pytest.approx(0.1 * turn / G, rel=1e-2)
    drawn = unpack(data["given"]["motion"]).reshape(-1, 6)[1]
    assert drawn == pytest.approx([0, 0, -100 * turn, 0, turn, 0], rel=1e-6, abs=1e-6)
    assert data["given"]["z"] == pytest.approx(-500)
    assert data["given"]["instability"] == pytest.approx(math.sqrt(0.1 * turn / G))
    assert unpack(data["patches"]["area"]) == pytest.approx([400 * 1000])
    # the map: a shift of 1 mm down gains 500 kg mm for gravity of length 1
    vertices = unpack(data["map"]["vertices"]).reshape(-1, 3)
    assert (data["map"]["mass"], (vertices @ [0, 0, -1]).max()) == pytest.approx((500, 500))
    on = block("on", [-2000, -500, 0], [-1000, 500, 1000], density=500.0)
    load = Load("on", force=[0, 0, -70], point=[-1500, 0, 1000])
    _, data = paged(Assembly([TABLE, on], units="mm", loads=[load]))
    assert data["loads"][0]["force"] == [0, 0, -70]
    at = np.array(data["loads"][0]["point"]) + data["center"]
    assert at == pytest.approx([-1500, 0, 1000])
    forces = unpack(data["given"]["forces"]["forces"]).reshape(-1, 3)
    assert forces.sum(axis=0) == pytest.approx([0, 0, 500 * G + 70], rel=1e-6)


@pytest.mark.slow
def test_a_torque_needs_friction_although_its_resultant_is_none() -> None:
    """A slab is turned by 60 % of the torque of friction at its corners, 300 sqrt 2 mm away."""
    slab = Part("slab", Box([600, 600, 20]), [-1500, 0, 10], mass=10.0)
    torque = 0.6 * 0.5 * 10 * G * 300 * math.sqrt(2)
    load = Load("slab", force=[0, 0, 0], torque=[0, 0, torque])
    rows, data = paged(Assembly([TABLE, slab], units="mm", loads=[load], friction=0.5))
    forces = data["given"]["forces"]
    assert unpack(forces["use"]) == pytest.approx([0.6] * 4, abs=1e-4)
    assert unpack(forces["forces"]).reshape(-1, 3).sum(axis=0)[:2] == pytest.approx(0, abs=1e-3)
    assert numbers(row_of(rows, "table", "slab", length=6)[3]) == [60]


@pytest.mark.slow
def test_the_fall_of_a_ball_off_a_ball_loses_its_weight_times_its_height() -> None:
    below = Part("below", kilter.Sphere(300.0), grounded=True)
    above = Part("above", kilter.Sphere(100.0), [0, 0, 400], mass=2.0)
    _, data = paged(Assembly([below, above], units="mm"))
    fall = data["given"]["fall"]["places"]
    motions = unpack(fall["motions"]).reshape(len(unpack(fall["energies"])), -1, 6)
    down = motions[:, 0, 2]
    assert down[-1] < -1
    assert unpack(fall["energies"]) == pytest.approx(2 * G * down * 1e-3, rel=1e-5, abs=1e-9)
    # the balls stay apart
    apart = np.linalg.norm(motions[:, 0, :3] + [0, 0, 400], axis=1)
    assert apart.min() >= 400 - 1e-3
