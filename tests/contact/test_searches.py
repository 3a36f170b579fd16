"""Searches for contacts: their results, tolerances and time, and searches that are kept."""

import dataclasses
import json
import random
from collections.abc import Callable
from itertools import count, pairwise
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest
from solids import bore, peg

import kilter
from kilter import Assembly, Box, Joint, Part, Pose, work
from kilter.assembly import GivenContact
from kilter.contact import ContactSet, Tolerance, contacts, detect, pair_findings
from kilter.contact import contact_tolerances as t
from kilter.contact.common import contact_search as recent_searches
from kilter.contact.common.gaps import nearest_gap, reach_of, touches
from kilter.contact.kept_contacts import KeptContacts
from kilter.errors import TimeLimitReached
from kilter.scenes import scene, stacks
from kilter.scenes.registry import SCENES
from kilter.tell.record import json_value
from kilter.tell.text import text_of
from kilter.work import stop_after
from literals import unnamed
from published import validator


def arrays(values):
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if isinstance(value, np.ndarray):
            yield field.name, value
        elif field.name in ("possible", "degenerate"):
            yield from arrays(value)


def test_every_array_of_contacts_is_read_only():
    found = detect.contacts(scene("tower"))
    held = dict(arrays(found))
    assert len(held) > 20
    assert [name for name, array in held.items() if array.flags.writeable] == []
    with pytest.raises(ValueError, match="read-only"):
        found.normals[0] = 0.0


def test_contacts_print_as_one_short_line():
    text = repr(detect.contacts(scene("tower")))
    assert "\n" not in text
    assert len(text) < 100
    assert text.startswith("<ContactSet: patches 5, points 20, pairs 5")


def test_contacts_know_the_names_and_joints_of_their_assembly():
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    found = detect.contacts(Assembly([floor, cube], joints=[Joint(("floor", "cube"))]))
    data = found.to_dict()
    assert [patch["parts"] for patch in data["patches"]] == [["floor", "cube"]]
    assert data["patches"][0]["area"] == 1.0
    assert data["joints"] == [{"parts": ["floor", "cube"], "kind": "fixed"}]
    assert data["units"] == "m"
    assert data["histogram"]["edges"][0] is data["histogram"]["edges"][-1] is None


CHAINS = [
    ("PATCH_ANGLE", "ANGLE", "LOOSE_ANGLE", "LOOKED_AT_ANGLE"),
    ("SAME_PLACE", "FACET_FLATNESS", "GAP", "ONE_POINT", "LOOSE_GAP"),
    ("CLUSTER", "LOOKED_AT_GAPS"),
    ("CONE_ANGLE", "NORMAL_SNAP", "NORMAL_ANGLE"),
    ("EXACT_ANGLE", "LITERAL_ANGLE", "CONE_ANGLE"),
    ("MEETS_EXACTLY", "SAME_PLACE", "VERTEX_ON_EDGE", "FACET_FLATNESS"),
    ("EDGE_PARALLEL", "EDGE_NEARLY_PARALLEL", "SMOOTH_ANGLE", "FACETED_ANGLE"),
]


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: " < ".join(chain))
def test_tolerances_are_ordered(chain):
    values = [getattr(t, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_one_true_normal_found_from_both_sides_is_one():
    # faces tilted by the angle tolerance, directions off by what counts as a plane, both ways
    assert t.ANGLE <= t.CONE_ANGLE
    assert t.ANGLE + t.CONE_ANGLE <= t.NORMAL_SNAP
    assert 2 * t.NORMAL_SNAP < t.NORMAL_ANGLE
    assert t.EDGE_STRAIGHTNESS == t.NORMAL_SNAP


def test_gaps_that_are_looked_at_hold_the_cluster():
    assert 1 < t.CLUSTER < t.LOOKED_AT_GAPS


def test_a_gap_tolerance_as_wide_as_a_play_adds_little_to_the_reach():
    # its limit lies above the reach of the default tolerance, and that of narrow ones grows with it
    assert t.LOOKED_AT_GAPS * t.GAP < t.LOOKED_AT_SIZE
    geometry = Assembly([Part("cube", Box([1, 1, 1]))]).geometry
    size = float(geometry.size[0])
    for gap, reach in (
        (1e-5, t.LOOKED_AT_GAPS * 1e-5),
        (1e-3, t.LOOKED_AT_SIZE * size),
        (0.02, t.CLUSTER * 0.02),
    ):
        assert reach_of(geometry, Tolerance(gap=gap)) == pytest.approx([reach / 2])


@pytest.mark.slow
def test_no_small_number_of_the_contacts_goes_without_a_name():
    assert unnamed("contact", but="_tolerances.py") == []


def test_a_gap_is_a_contact_up_to_its_limits():
    gap = np.array([[0.9, 2.0], [1.1, 2.0], [-2.0, -0.4], [-2.0, -0.6], [-9.0, 9.0]])
    closed, deepest = np.full(5, 1.0), np.full(5, 0.5)
    assert touches(gap, deepest, closed).tolist() == [True, False, True, False, True]
    assert nearest_gap(gap).tolist() == [0.9, 1.1, -0.4, -0.6, 0.0]


def test_gap_tolerance_is_given_or_follows_the_size():
    size = np.array([1.0, 20.0])
    assert Tolerance().gap_of(size).tolist() == [t.GAP, 20 * t.GAP]
    assert Tolerance(gap=0.5).gap_of(size).tolist() == [0.5, 0.5]


def pegs() -> Assembly:
    """A peg with play in a bore, and a tight one in another bore."""
    plates = [
        Part(name, bore(1.0, 3.0, 0.0, 1.0, sides=48), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", 0.0), ("right", 10.0))
    ]
    shafts = [
        Part("loose", peg(0.95, 0.0, 2.0, sides=48), Pose([0.01, 0, 0])),
        Part("tight", peg(1.01, 0.0, 2.0, sides=48), Pose([10, 0, 0])),
    ]
    return Assembly([*plates, *shafts])


def fresh(assembly: Assembly) -> Assembly:
    """A copy with a geometry of its own, which no recent search knows."""
    parts = [dataclasses.replace(part) for part in assembly.parts]
    return dataclasses.replace(assembly, parts=parts)


def assert_equal(first: kilter.ContactSet, second: kilter.ContactSet) -> None:
    """Compare all arrays and records of two contact sets."""
    for field in dataclasses.fields(first):
        one, other = getattr(first, field.name), getattr(second, field.name)
        if isinstance(one, np.ndarray):
            np.testing.assert_array_equal(one, other, err_msg=field.name)
        elif isinstance(one, tuple):
            assert repr(one) == repr(other), field.name  # records with arrays have no ==
    assert first.to_dict() == second.to_dict()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tower", "pegs"])
@pytest.mark.parametrize(
    "tolerance", [Tolerance(gap=0.1), Tolerance.loose(), Tolerance(clearance=0.08)]
)
def test_another_tolerance_gives_the_contacts_of_a_new_geometry(name, tolerance):
    assembly = pegs() if name == "pegs" else scene(name)
    kilter.contacts(assembly)
    again = kilter.contacts(assembly, tolerance=tolerance)
    assert_equal(again, kilter.contacts(fresh(assembly), tolerance=tolerance))


@pytest.mark.slow
def test_equal_conditions_need_no_second_search(monkeypatch):
    """Friction changes no finding; a new tolerance, and a new geometry, need a search."""
    assembly = pegs()
    examined = []
    examine = detect.examine
    monkeypatch.setattr(
        detect, "examine", lambda *given: examined.append(given[2]) or examine(*given)
    )
    kilter.contacts(assembly)
    rubbing = kilter.contacts(assembly.with_friction(0.4))
    assert len(examined) == 1
    assert (rubbing.patch_mu == 0.4).all()
    kilter.contacts(assembly, tolerance=Tolerance(gap=0.1))
    assert len(examined) == 2
    kilter.contacts(fresh(assembly))
    assert len(examined) == 3


def test_given_contacts_are_a_condition_of_a_search():
    assembly = scene("tower")
    found = kilter.contacts(assembly)
    a, b = (assembly.names[k] for k in found.patch_parts[0])
    given = kilter.GivenContact((a, b), found[0].points, found[0].normal)
    listed = dataclasses.replace(assembly, contacts=(given,))
    vars(listed)["geometry"] = assembly.geometry
    kinds = kilter.contacts(listed).patch_kind.tolist()
    assert kinds.count("given") == 1
    assert len(kinds) == len(found)


@pytest.mark.slow
def test_searches_of_large_geometries_are_not_kept(monkeypatch):
    assembly = pegs()
    monkeypatch.setattr(recent_searches, "MOST_TRIANGLES", 10)
    kilter.contacts(assembly)
    assert recent_searches.recent_searches(assembly.geometry).search is None


def test_the_oldest_findings_give_way():
    assembly = scene("tower")
    for k in range(recent_searches.MOST_FINDINGS + 2):
        kilter.contacts(assembly, tolerance=Tolerance(gap=1e-6 * (k + 1)))
    kept = recent_searches.recent_searches(assembly.geometry).findings
    gaps = [tolerance.gap for tolerance, *_ in kept]
    assert gaps == pytest.approx([1e-6 * k for k in (3, 4, 5, 6)])


QUICK = ("tower", "wall", "paper-figure-8", "ball-in-groove")
CHANGES = 4
MOST_PARTS = 120


def written(contacts: ContactSet) -> str:
    """Everything about contacts as text."""
    possible, degenerate = contacts.possible, contacts.degenerate
    arrays = [possible.part_a, possible.part_b, possible.points, possible.normals, possible.mu]
    arrays += [possible.two_sided, possible.degenerate, degenerate.part_a, degenerate.normals]
    arrays += [degenerate.held_parts, degenerate.held_points, contacts.patch_doubt]
    return json.dumps([contacts.to_dict(), *(array.tolist() for array in arrays)])


def changed(assembly: Assembly, kept: KeptContacts, rng: random.Random) -> Assembly:
    """A random change that keeps the bodies in place."""
    names = list(assembly.names)
    other = assembly
    if rng.random() < 0.5:
        other = other.with_friction(rng.choice([0, 0.3, 0.7]))
    if rng.random() < 0.5 and len(names) > 3:
        other = other.without(rng.sample(names, rng.randint(1, 2)))
    always = {part.name for part in kept.assembly.parts if part.grounded}
    share = rng.random()
    loaded = {load.part for load in other.loads}
    parts = [
        dataclasses.replace(
            part,
            grounded=part.name in always
            or part.table
            or (part.name not in loaded and rng.random() < share),
        )
        for part in other.parts
    ]
    other = dataclasses.replace(other, parts=parts)
    if rng.random() < 0.4 and len(other.names) > 2:
        pair = tuple(rng.sample(other.names, 2))
        given = [c for c in other.contacts if set(c.parts) != set(pair)]
        other = dataclasses.replace(
            other, contacts=[*given, GivenContact((pair[0], pair[1]), [], [0, 0, 1])]
        )
    return other


def require_same_points(kept: ContactSet, new: ContactSet) -> None:
    """Equal patches up to rounding, and up to the order of the points.

    Equal pairs of CAD bodies are searched once. Which pair is searched depends on the held parts,
    so that the points of a copy begin elsewhere.
    """
    kept_data, new_data = (json.loads(written(found))[0] for found in (kept, new))
    assert kept_data["unsupported"] == new_data["unsupported"]
    assert len(kept_data["patches"]) == len(new_data["patches"])
    for a, b in zip(kept_data["patches"], new_data["patches"], strict=True):
        assert (a["parts"], a["kind"], a["mu"]) == (b["parts"], b["kind"], b["mu"])
        first, second = np.array(a["points"]), np.array(b["points"])
        assert first.shape == second.shape
        assert a["area"] == pytest.approx(b["area"], rel=1e-9)
        apart = np.linalg.norm(first[:, None] - second, axis=2)
        near = 1e-11 * np.abs(first).max()
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) <= near


def compare(assembly: Assembly, seed: int, *, exactly: bool = True) -> int:
    """Compare kept with new contacts for random changes; return the number of comparisons."""
    rng = random.Random(seed)
    tolerance = assembly.tolerance or Tolerance()
    held = [part.name for part in assembly.parts if part.grounded and not part.table]
    kept = KeptContacts.find(assembly, tolerance, held=[n for n in held if rng.random() < 0.3])
    compared = 0
    for _ in range(CHANGES):
        try:
            other = changed(assembly, kept, rng)
        except kilter.InputError:
            continue  # for instance a joint whose part is left out
        if not kept.serves(other, tolerance):
            continue
        new = detect.contacts(other, tolerance=tolerance)
        if exactly:
            assert written(kept.contacts(other)) == written(new)
        else:
            require_same_points(kept.contacts(other), new)
        compared += 1
    return compared


@pytest.mark.parametrize("name", [name for name in QUICK if name in SCENES])
def test_kept_contacts_equal_those_of_a_new_search(name):
    assert compare(scene(name), 1) > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_kept_contacts_of_every_example(seed):
    small = [name for name in sorted(SCENES) if len(scene(name).parts) <= MOST_PARTS]
    assert sum(compare(scene(name), seed) for name in small) > 2 * len(small)


DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
FILES = ("cax-if/as1-oc-214.stp", "cax-if/dm1-id-214.stp", "cad/flange_coupling.step")


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_kept_contacts_of_cad(name):
    if not (DATA / name).exists():
        pytest.skip("../shared/data is not here")
    assert compare(kilter.load(DATA / name), 3, exactly=False) > 0


def test_another_shape_pose_tolerance_or_free_part_is_not_served():
    tower = scene("tower")
    tolerance = Tolerance()
    base = next(part.name for part in tower.parts if part.grounded)
    kept = KeptContacts.find(tower, tolerance, held=[base])
    assert kept.serves(tower, tolerance)
    assert not kept.serves(tower, Tolerance(gap=0.1))
    assert not kept.serves(tower.with_pose("cube-1", [0, 0, 5]), tolerance)
    free = [dataclasses.replace(part, grounded=False) for part in tower.parts]
    assert not kept.serves(dataclasses.replace(tower, parts=free), tolerance)
    renamed = tower.renamed({"cube-1": "other"})
    assert not kept.serves(renamed, tolerance)


ARRAYS = ("patch_parts", "patch_area", "patch_start", "points", "normals", "gap_counts")
RECORDS = ("rejected", "overlaps", "unsupported", "open_pairs", "fits", "warnings")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Function that sets the clock of time limits: the n-th batch of pairs ends late."""
    now = [0.0]
    examine = pair_findings.examine
    monkeypatch.setattr(work, "perf_counter", lambda: now[0])
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 2)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)

    def late_from(batch: int) -> None:
        numbers = count(1)

        def timed(*arguments: object) -> object:
            findings = examine(*arguments)
            if next(numbers) == batch:
                now[0] += 100.0
            return findings

        monkeypatch.setattr(pair_findings, "examine", timed)

    return late_from


@pytest.mark.parametrize("name", ["arch", "paper-figure-3-vertices", "three-cylinders", "box-pile"])
def test_batches_change_no_contact(name, monkeypatch):
    assembly = scene(name)
    whole = contacts(assembly)
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 1)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)
    batches = contacts(assembly, time_limit=1000.0)
    for key in ARRAYS:
        assert np.array_equal(getattr(batches, key), getattr(whole, key))
    for key in RECORDS:
        assert json_value(getattr(batches, key)) == json_value(getattr(whole, key))
    for key in ("part_a", "points", "normals", "degenerate"):
        assert np.allclose(getattr(batches.possible, key), getattr(whole.possible, key))
    assert np.array_equal(batches.degenerate.normals, whole.degenerate.normals)


def cut_tower(late_from: Callable[[int], None]) -> tuple[Assembly, ContactSet]:
    """A tower of 5 cubes whose search ends after 2 of its 5 pairs."""
    tower = scene("tower")
    late_from(1)
    return tower, contacts(tower, time_limit=1.0)


def test_pairs_after_the_limit_are_open(clock):
    _, cut = cut_tower(clock)
    assert (cut.pairs, cut.unexamined) == (2, 3)
    assert {pair.kind for pair in cut.open_pairs} == {"unexamined"}
    assert not len(cut.alone)
    assert "the time limit was reached: the contacts of 3 pairs of parts were not examined" in (
        cut.warnings
    )
    validator("contacts")(cut.to_dict())
    assert "a longer --time-limit" in text_of(cut.to_dict())


def test_a_verdict_on_unexamined_pairs_is_undecided(clock):
    tower, cut = cut_tower(clock)
    verdict = kilter.check(tower, contacts=cut)
    assert verdict.sentence == (
        "Undecided: the time limit was reached; known so far: 2 pairs of parts touch, the "
        "contacts of 3 pairs of parts were not examined, 3 pairs are open, no forces of the "
        "certain contacts hold it."
    )
    validator("check")(verdict.to_dict())


def test_the_first_batch_may_be_cut(monkeypatch):
    def late(*arguments: object) -> object:
        if len(arguments[1].pairs):  # type: ignore[attr-defined]
            raise TimeLimitReached
        return examine(*arguments)  # type: ignore[arg-type]

    examine = pair_findings.examine
    monkeypatch.setattr(pair_findings, "examine", late)
    cut = contacts(scene("tower"), time_limit=1.0)
    assert (cut.pairs, cut.unexamined) == (0, 5)


def test_a_search_inside_a_limit_of_another_computation_raises():
    # incomplete contacts that nobody requested would be taken for complete ones
    with stop_after(0.0), pytest.raises(TimeLimitReached):
        contacts(stacks.tower())


@pytest.mark.parametrize(
    ("analysis", "contacts_of"),
    [
        (kilter.check, "contact_set"),
        (kilter.states, "contacts"),
        (kilter.margin, "contacts"),
        (kilter.hold, "contacts"),
        (kilter.plan, "states.contacts"),
        (kilter.region, "contacts"),
        (kilter.orient, "stable_region.contacts"),
    ],
)
def test_every_analysis_passes_its_limit_to_the_search(analysis, contacts_of, clock):
    clock(1)
    found = attrgetter(contacts_of)(analysis(scene("tower"), time_limit=1.0))
    one = found[0] if isinstance(found, tuple) else found
    assert one.unexamined == 3
