"""Least and greatest contact forces: closed forms, a second program, squeezes, wrong input."""

import json
import math

import numpy as np
import pytest
from scipy.optimize import linprog
from transformations import scaled

import kilter
from kilter import Assembly, Box, InputError, Mesh, Part
from kilter.analysis.analysis_tolerances import RANGE_AGREES
from kilter.cli import main
from kilter.rigid import Pose
from kilter.scenes.pieces import moved, turn
from kilter.scenes.walls import wall_of

G = 9.81
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def ends(assembly, between, along=None):
    (found,) = kilter.check(assembly).force_ranges([between], along)
    assert found.least.proved
    assert found.greatest.proved
    return found.least.value, found.greatest.value


def wedge(name, corners, **options):
    """A prism over four corners (x, z), from y = 0 to 1."""
    vertices = np.array([[x, y, z] for y in (0.0, 1.0) for x, z in corners])
    return Part(name, Mesh(vertices, QUADS), **options)


def test_a_box_presses_with_its_weight_and_with_nothing_else():
    held = Part("floor", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    scene = Assembly([held, Part("box", Box(1, 1, 1), [0.2, 0.1, 0.5])], friction=0.5)
    weight = 1000 * G
    assert ends(scene, ("floor", "box")) == pytest.approx((weight, weight), rel=1e-9)
    assert ends(scene, ("floor", "box"), [0, 0, 1]) == pytest.approx((weight, weight), rel=1e-9)
    assert ends(scene, ("box", "floor"), [0, 0, 1]) == pytest.approx((-weight, -weight), rel=1e-9)
    assert ends(scene, ("floor", "box"), [1, 0, 0]) == (0, 0)


def test_each_leg_of_a_table_carries_up_to_half_of_it():
    feet = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    held = [Part(f"f{k}", Box(0.5, 0.5, 1), [*p, -0.5], grounded=True) for k, p in enumerate(feet)]
    points = [
        kilter.GivenContact((f"f{k}", "top"), [[*p, 0]], [0, 0, 1]) for k, p in enumerate(feet)
    ]
    top = Part("top", Box(3, 3, 0.5), [0, 0, 0.25])
    scene = Assembly([*held, top], contacts=points, detect=False)
    half = 0.5 * 4.5 * 1000 * G
    for k in range(4):
        assert ends(scene, (f"f{k}", "top")) == pytest.approx((0, half), rel=1e-9, abs=1e-6)


def knife(name, x):
    """A held prism with its edge along y at (x, 0)."""
    low = [[x - 0.3, y, -1.0] for y in (0, 1)] + [[x + 0.3, y, -1.0] for y in (0, 1)]
    faces = [[0, 2, 4], [1, 5, 3], [0, 1, 3, 2], [0, 4, 5, 1], [2, 3, 5, 4]]
    return Part(name, Mesh(np.array([[x, 0, 0], [x, 1, 0], *low]), faces), grounded=True)


def beam_on_three():
    knives = [knife(f"knife-{k}", x) for k, x in enumerate((-2, 0, 2))]
    return Assembly([*knives, Part("beam", Box(4.4, 1, 0.5), [0, 0.5, 0.25])])


def test_a_beam_on_three_supports_lies_on_the_middle_or_on_the_ends():
    scene = beam_on_three()
    weight = 2.2 * 1000 * G
    assert ends(scene, ("knife-1", "beam")) == pytest.approx((0, weight), rel=1e-9, abs=1e-6)
    for k in (0, 2):
        found = ends(scene, (f"knife-{k}", "beam"))
        assert found == pytest.approx((0, weight / 2), rel=1e-9, abs=1e-6)


def slot(mu=0.5):
    walls = [
        Part(n, Box(1, 1, 2), [x, 0, 0], grounded=True) for n, x in (("left", -1), ("right", 1))
    ]
    return Assembly([*walls, Part("block", Box(1, 1, 1))], friction=mu)


def test_a_block_in_a_slot_can_be_squeezed_without_a_limit():
    (found,) = kilter.check(slot(), require="equilibrium").force_ranges([("left", "block")])
    # each wall carries half of the weight at least by friction: 2 mu N >= W
    assert found.least.value == pytest.approx(1000 * G / (2 * 0.5), rel=1e-9)
    assert found.greatest.value is None
    assert found.greatest.proved
    assert "without an upper limit" in found.sentence


def arch(count, thickness, mu=0.7):
    """Voussoirs between circles of radius 5 and 5 + t on two horizontal supports."""
    angle = np.linspace(0, math.pi, count + 1)
    parts = []
    for k in range(count):
        corners = [(r * math.cos(a), r * math.sin(a))
                   for a in angle[k : k + 2] for r in (5.0, 5.0 + thickness)]  # fmt: skip
        parts.append(wedge(f"v{k}", corners))
    wide, far = thickness + 1, 5 + thickness / 2
    right = Part("right", Box(wide, 1, 1), [far, 0.5, -0.5], grounded=True)
    left = Part("left", Box(wide, 1, 1), [-far, 0.5, -0.5], grounded=True)
    return Assembly([right, *parts, left], friction=mu)


def thrust_in_the_plane(count, thickness, mu):
    """Least and greatest thrust over the weight by a linear program of normal and shear forces.

    Unknowns: at both ends of each joint, from the right springing: normal and shear force.
    """
    angle = np.linspace(0, math.pi, count + 1)
    radii = np.array([5.0, 5.0 + thickness])
    points = np.array([[[r * math.cos(a), r * math.sin(a)] for r in radii] for a in angle])
    normals = np.array([[-math.sin(a), math.cos(a)] for a in angle])  # into the next block
    shears = np.array([[math.cos(a), math.sin(a)] for a in angle])
    balance, load, weight = [], [], 0.0
    size = 4 * (count + 1)
    for k in range(count):
        quad = np.array([points[k, 0], points[k, 1], points[k + 1, 1], points[k + 1, 0]])
        after = np.roll(quad, -1, axis=0)
        twice = quad[:, 0] * after[:, 1] - quad[:, 1] * after[:, 0]
        area = twice.sum() / 2
        centre = (quad + after).T @ twice / (6 * area)
        rows = np.zeros((3, size))
        for joint, sign in ((k, 1), (k + 1, -1)):
            for end in (0, 1):
                arm = points[joint, end] - centre
                for which, along in enumerate((normals[joint], shears[joint])):
                    column = 4 * joint + 2 * end + which
                    rows[:2, column] = sign * along
                    rows[2, column] = sign * (arm[0] * along[1] - arm[1] * along[0])
        balance.append(rows)
        load.append([0, area, 0])
        weight += area
    cones = np.zeros((4 * (count + 1), size))
    for k in range(2 * (count + 1)):
        cones[2 * k, [2 * k, 2 * k + 1]] = -mu, 1
        cones[2 * k + 1, [2 * k, 2 * k + 1]] = -mu, -1
    cost = np.zeros(size)
    for end in (0, 1):
        cost[2 * end : 2 * end + 2] = -normals[0][0], -shears[0][0]
    bounds = [(0, None), (None, None)] * (2 * (count + 1))
    given = {
        "A_eq": np.concatenate(balance), "b_eq": np.concatenate(load), "A_ub": cones,
        "b_ub": np.zeros(len(cones)), "bounds": bounds, "method": "highs",
    }  # fmt: skip
    return linprog(cost, **given).fun / weight, -linprog(-cost, **given).fun / weight


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("count", "thickness", "least", "greatest"),
    [
        (20, 1, 0.161579331, 0.245949059),
        (20, 0.75, 0.180916505, 0.221139496),
        (10, 1, 0.161980057, 0.248119319),
        (20, 1.5, 0.131513909, 0.282624950),
    ],
)
def test_thrust_of_an_arch(count, thickness, least, greatest):
    scene = arch(count, thickness)
    weight = scene.geometry.mass[~scene.geometry.grounded].sum() * G
    low, high = ends(scene, ("right", "v0"), [-1, 0, 0])
    assert (low / weight, high / weight) == pytest.approx((least, greatest), abs=1e-8)
    planar = thrust_in_the_plane(count, thickness, 0.7)
    assert (low / weight, high / weight) == pytest.approx(planar, abs=1e-8)


@pytest.mark.slow
def test_at_the_critical_thickness_least_and_greatest_thrust_meet():
    low, high = 0.4, 0.7
    while high - low > 1e-9:
        middle = (low + high) / 2
        stands = kilter.check(arch(10, middle), require="equilibrium").level is not None
        low, high = (low, middle) if stands else (middle, high)
    widths = []
    for more in (1e-3, 1e-4):
        least, greatest = ends(arch(10, high + more), ("right", "v0"), [-1, 0, 0])
        widths.append((greatest - least) / greatest)
    assert widths[0] < 0.01
    assert widths[1] == pytest.approx(widths[0] / 10, rel=0.05)


@pytest.mark.slow
def test_the_shown_forces_lie_within_their_ranges():
    verdict = kilter.check(arch(10, 1))
    shown = {frozenset(p.parts): p.normal_force for p in verdict.forces.patches}
    ranges = verdict.force_ranges()
    assert len(ranges) == len(shown) == 11
    for one in ranges:
        value = shown[frozenset(one.parts)]
        assert one.least.value - 1e-6 <= value <= one.greatest.value + 1e-6
        assert one.least.bound <= one.least.value + 1e-3
        assert one.greatest.bound >= one.greatest.value - 1e-3


def test_a_held_part_carries_the_sum_of_its_pairs():
    held = Part("floor", Box(8, 4, 1), [0, 0, -0.5], grounded=True)
    boxes = [Part(f"box-{k}", Box(1, 1, 1), [2 * k, 0, 0.5]) for k in range(3)]
    (found,) = kilter.check(Assembly([held, *boxes])).force_ranges(["floor"])
    assert found.least.value == pytest.approx(3 * 1000 * G, rel=1e-9)
    assert found.greatest.value == pytest.approx(3 * 1000 * G, rel=1e-9)
    assert found.parts == ("floor",)


def test_friction_that_is_used_at_an_end_is_on_the_cone():
    # a block on a slope of 20 deg, leaning on a held stop below it: friction may carry all or less
    down = 20
    floor = Part("floor", Box(6, 2, 1), [0, 0, -0.5], grounded=True)
    stop = Part("stop", Box(1, 2, 1), [1, 0, 0.5], grounded=True)
    block = Part("block", Box(1, 1, 1), [0, 0, 0.5])
    tilt = math.radians(down)
    gravity = [G * math.sin(tilt), 0, -G * math.cos(tilt)]
    mu, weight = 0.2, 1000 * G
    made = Assembly([floor, stop, block], gravity=gravity, friction=mu)
    low, high = ends(made, ("stop", "block"), [-1, 0, 0])
    # the stop carries at least what the friction of floor leaves; both friction forces help
    n_floor = weight * math.cos(tilt)
    assert high >= weight * math.sin(tilt) - 1e-6
    # least: N = W sin - mu R, with the floor force R = W cos + mu N (the stop pulls the block down)
    least = (weight * math.sin(tilt) - mu * n_floor) / (1 + mu * mu)
    assert low == pytest.approx(least, rel=1e-7)


@pytest.mark.parametrize("mu", [0.0, 0.6])
def test_an_interior_point_finds_the_ends_of_the_simplex_method(mu, monkeypatch):
    from kilter.analysis import force_ranges

    scene = wall_of(6).with_friction(mu)
    simplex = kilter.check(scene).force_ranges()
    monkeypatch.setattr(force_ranges, "LARGE", 0)
    interior = kilter.check(scene).force_ranges()
    for a, b in zip(simplex, interior, strict=True):
        for first, second in ((a.least, b.least), (a.greatest, b.greatest)):
            assert first.proved
            assert second.proved
            size = 2 * RANGE_AGREES * a.weight
            assert (first.value, first.bound) == pytest.approx((second.value,) * 2, abs=size)
            # forces and multipliers are those of another method
            assert first.bound != second.bound or first.value == second.value == 0.0


def test_an_assembly_that_falls_has_no_ranges():
    falling = arch(10, 0.3)
    assert kilter.check(falling).force_ranges() == ()


def test_wrong_names_and_pairs_are_sentences():
    verdict = kilter.check(arch(10, 1))
    with pytest.raises(InputError, match="'v0' and 'v5' have no contact"):
        verdict.force_ranges([("v0", "v5")])
    with pytest.raises(InputError, match="no part is named 'w0'"):
        verdict.force_ranges([("w0", "v5")])


def off_centre(units, unit):
    """A box off the centre of its held floor, with lengths of a unit [m]."""
    size = 1 / unit
    floor = Part("floor", Box(4 * size, 4 * size, size), [0, 0, -size / 2], grounded=True)
    box = Part("box", Box(size, size, size), [0.2 * size, 0.1 * size, size / 2])
    return Assembly([floor, box], friction=0.5, units=units)


@pytest.mark.parametrize(("units", "unit"), [("m", 1.0), ("mm", 1e-3)])
@pytest.mark.parametrize(("axis", "moment"), [((0, 1, 0), 0.2), ((2, 0, 0), -0.1), ((0, 0, 1), 0)])
def test_the_moment_of_a_reaction_is_that_of_the_weight(units, unit, axis, moment):
    verdict = kilter.check(off_centre(units, unit))
    (found,) = verdict.force_ranges(["floor"], moment=axis)
    for end in (found.least, found.greatest):
        assert end.proved
        assert end.value == pytest.approx(moment * 1000 * G, rel=1e-9, abs=1e-6)
    assert found.sentence.endswith(" N m")


def test_a_middle_block_moves_the_force_on_a_beam_aside():
    """Its force N at most half from the middle has the moment N / 2 <= 2 (W - N), so N = .8 W."""
    middle = Part("middle", Box(1, 1, 1), [0, 0.5, -0.5], grounded=True)
    beam = Part("beam", Box(4.4, 1, 0.5), [0, 0.5, 0.25])
    scene = Assembly([knife("first", -2), middle, knife("last", 2), beam])
    (found,) = kilter.check(scene).force_ranges([("middle", "beam")], moment=[0, 1, 0])
    most = 0.4 * 2.2 * 1000 * G
    assert (found.least.value, found.greatest.value) == pytest.approx((-most, most), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-2, 1.0, 1e2])
def test_ranges_turn_and_grow_with_the_assembly(size):
    pose = Pose([3, -2, 5], turn([1, 2, -1], 37))
    for scene, pair, axis in (
        (arch(10, 1), ("right", "v0"), [-1, 0, 0]),
        (arch(10, 1), ("v4", "v5"), None),
        (beam_on_three(), ("knife-1", "beam"), None),
        (beam_on_three(), ("knife-0",), [0, 0, 1]),
    ):
        first = ends(scene, pair, axis)
        turned = None if axis is None else pose.matrix @ axis
        second = ends(moved(scaled(scene, size), pose.rotation, pose.position), pair, turned)
        most = max(map(abs, first))
        assert np.array(second) / size**3 == pytest.approx(first, abs=1e-8 * most)


@pytest.mark.slow
def test_the_command_lists_ranges_and_one_possible_set(tmp_path, capsys):
    path = str(tmp_path / "arch.kilter.json")
    assert main(["example", "arch", "-o", path, "--force"]) == 0
    capsys.readouterr()
    assert main(["check", path, "--forces"]) == 0
    out = capsys.readouterr().out
    assert "Normal forces, least and greatest of all equilibria:" in out
    assert "One possible set of contact forces" in out
    words = ["--between", "voussoir-0", "voussoir-1", "--along", "x", "--json"]
    assert main(["check", path, *words]) == 0
    (found,) = json.loads(capsys.readouterr().out)["ranges"]
    assert found["parts"] == ["voussoir-0", "voussoir-1"]
    assert found["along"] == [1, 0, 0]
    assert found["least"]["value"] < found["greatest"]["value"] < 0
    assert main(["check", path, "--along", "x"]) == 2
    assert "--along needs forces" in capsys.readouterr().err
    assert main(["check", path, "--forces", "--along", "1,2"]) == 2
    assert "give x, y, z, or X,Y,Z" in capsys.readouterr().err
    assert main(["check", path, "--between", "springer-left", "all", "--moment", "y"]) == 0
    out = capsys.readouterr().out
    assert "Moments [N m] on the held part about (0, 1, 0), least and greatest" in out
    assert main(["check", path, "--moment", "y"]) == 2
    assert "--moment needs forces" in capsys.readouterr().err
    assert main(["check", path, "--forces", "--along", "x", "--moment", "y"]) == 2
    assert "along and moment are both given" in capsys.readouterr().err
