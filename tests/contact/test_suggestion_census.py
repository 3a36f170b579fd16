"""Suggestions over random assemblies with known joints: these and no others."""

import numpy as np
import pytest
from solids import pin
from transformations import scaled

from kilter import check, fastened
from kilter.assembly import Assembly, Joint
from kilter.contact import contacts
from kilter.contact.fits.suggestions import suggest_joints
from kilter.scenes.pieces import block, moved, tube, turn

SCENES = 24
WORDS = ["part", "Body", "Solid", "case/side", "a-1", "x y", "Teil", "12", "cover"]


class Bench:
    """A held plate with stations on it, and the joints of their construction."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.parts = [block("bench", [-300, -40, -9], [300, 40, 0], grounded=True)]
        self.joints: list[tuple[str, str, str]] = []
        self.named = 0

    def name(self, tail: str = "") -> str:
        self.named += 1
        return f"{self.rng.choice(WORDS)} {self.named}{tail and '/' + tail}"

    def number(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def build(self, threads: bool) -> Assembly:
        """Two to five stations; with `threads`, at least one station is a screw in its thread."""
        every = [
            self.thread,
            self.press,
            self.insert,
            self.overlap,
            self.nut,
            self.play,
            self.stack,
        ]
        chosen = [every[k] for k in self.rng.integers(0 if threads else 1, 7, size=4)]
        if threads:
            chosen[0] = self.thread
        for k, station in enumerate(chosen[: int(self.rng.integers(2, 5))]):
            first = len(self.parts)
            station()
            spin = turn([0, 0, 1], self.number(0, 360))
            placed = moved(Assembly(self.parts[first:]), spin, [120.0 * k - 200, 0, 0])
            self.parts[first:] = placed.parts
        assembly = Assembly(self.parts, units="mm", friction=float(self.rng.choice([0.0, 0.4])))
        axis = self.rng.normal(size=3)
        assembly = moved(assembly, turn(axis, self.number(0, 180)), self.rng.normal(size=3) * 50)
        return scaled(assembly, float(self.rng.choice([1.0, 0.013, 40.0])))

    def fit(self, share: float, kind: str, *, hole: str = "", shaft: str = "") -> None:
        """A tube that stands on the bench, and a shaft thicker than its bore by a fraction."""
        bore, height = self.number(3, 12), self.number(8, 20)
        radius = bore / (1 - share)
        sides = int(self.rng.integers(64, 100))
        one = tube(self.name(hole), bore, 1.9 * radius, height, [0, 0, height / 2], sides=sides)
        self.parts.append(one)
        long = self.number(6, 20)
        rest = height / 2 + self.number(-0.3, 0.4) * long
        self.parts.append(pin(self.name(shaft), radius, long, [0, 0, max(rest, long / 2 + 0.5)]))
        self.joints.append((self.parts[-1].name, one.name, kind))

    def thread(self) -> None:
        self.fit(self.number(0.03, 0.2), "thread")

    def press(self) -> None:
        self.fit(self.number(0.003, 0.018), "press fit")

    def nut(self) -> None:
        self.fit(0.0, "thread", hole=str(self.rng.choice(["nut", "M5 Nut", "insert_2"])))

    def insert(self) -> None:
        bore, height = self.number(5, 9), self.number(8, 14)
        outer = bore / (1 - self.number(0.003, 0.05))
        body = tube(self.name(), bore, 2 * outer, height, [0, 0, height / 2], sides=80)
        ring = tube(self.name(), 0.5 * bore, outer, 0.6 * height, [0, 0, 0.6 * height], sides=80)
        self.parts += [body, ring]
        self.joints.append((ring.name, body.name, "insert"))

    def overlap(self) -> None:
        """A leg with a lid sunk into it, sometimes so far aside that it tips."""
        high, wide = self.number(10, 30), self.number(10, 20)
        leg = block(self.name(), [-wide / 2, -wide / 2, 0], [wide / 2, wide / 2, high])
        aside = self.number(0, 0.9) * wide
        low = high - self.number(0.01, 2.0)
        lid = block(self.name(), [-wide / 2 + aside, -5, low], [wide / 2 + 2 * aside, 5, low + 6])
        self.parts += [leg, lid]
        self.joints.append((leg.name, lid.name, "overlap"))

    def play(self) -> None:
        """A pin that stands on the bench in a wider ring: no fit."""
        bore = self.number(5, 9)
        self.parts.append(tube(self.name(), bore, 1.7 * bore, 5, [0, 0, 2.5]))
        self.parts.append(pin(self.name(), bore * self.number(0.5, 0.7), 12, [0, 0, 6]))

    def stack(self) -> None:
        """Blocks on each other that touch and are not joined."""
        high = self.number(5, 10)
        self.parts.append(block(self.name(), [-6, -6, 0], [6, 6, high]))
        aside = self.number(0, 5)
        self.parts.append(block(self.name(), [-5 + aside, -5, high], [5 + aside, 5, high + 4]))


@pytest.mark.slow
@pytest.mark.parametrize("threads", [False, True])
@pytest.mark.parametrize("seed", range(SCENES // 2))
def test_suggestions_are_the_joints_that_it_was_built_with(seed, threads):
    bench = Bench(1000 * threads + seed)
    assembly = bench.build(threads)
    found = contacts(assembly)
    suggested = {
        (frozenset(one.parts), one.kind) for one in suggest_joints(assembly, found) if one.fixed
    }
    built = {(frozenset((a, b)), kind) for a, b, kind in bench.joints}
    assert suggested == built
    joined = fastened(assembly, suggested=True, contacts=found)
    assert suggest_joints(joined, found) == [
        one for one in suggest_joints(joined, found) if not one.fixed
    ]
    wanted = assembly.with_joints([Joint((a, b)) for a, b, _ in bench.joints])
    one, other = check(joined), check(wanted)
    assert one.verdict == other.verdict
    assert one.moving == other.moving
