"""The same answer bit for bit, whoever asks beside: threads, processes, a process forked late."""

from __future__ import annotations

import json
import multiprocessing
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import pytest

import kilter
from kilter.assembly import Assembly
from kilter.scenes import friction, paper, stacks, walls

THREADS, PROCESSES = 8, 4
SCENES: dict[str, Callable[[], Assembly]] = {
    "figure 8": paper.figure_8,
    "figure 9": lambda: paper.figure_9(planar=True),
    "slope": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "bracket": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
    "wall": lambda: walls.wall_of(12, friction=0.6).with_down([0.0, 0.02, -1.0]),
}
ANSWERS: dict[str, Callable[[Assembly], str]] = {
    "check": lambda one: _text(kilter.check(one, effort=0.5).proof()),
    "contacts": lambda one: _text(kilter.contacts(one).to_dict()),
    "orient": lambda one: _text(_timeless(kilter.orient(one).to_dict())),
    "region": lambda one: _text(kilter.region(one).proof()),
}
ASKED = [("figure 9", "contacts"), ("figure 8", "check"), ("slope", "check")]
MORE = [(scene, "check") for scene in SCENES] + [("figure 9", answer) for answer in ANSWERS]


def _text(data: object) -> str:
    return json.dumps(data, sort_keys=True)


def _timeless(data: object) -> object:
    """An answer without how long it took."""
    if isinstance(data, dict):
        return {key: _timeless(value) for key, value in data.items() if key != "seconds"}
    return [_timeless(one) for one in data] if isinstance(data, list) else data


def answered(scene: str, answer: str) -> str:
    """In a process of its own, of an assembly of its own."""
    return ANSWERS[answer](SCENES[scene]())


Asked = list[tuple[str, str]]
FEW_OR_ALL = pytest.mark.parametrize(
    "asked", [ASKED, pytest.param(MORE, marks=pytest.mark.slow)], ids=["few", "more"]
)


def alone(asked: Asked) -> dict[tuple[str, str], str]:
    """What each asks for, one after the other, of assemblies that no other has."""
    return {one: answered(*one) for one in asked}


@pytest.mark.slow
@FEW_OR_ALL
def test_threads_that_share_assemblies(asked: Asked) -> None:
    """All begin at once: what an assembly keeps once it is asked for is asked for by all."""
    shared = {name: build() for name, build in SCENES.items()}
    together = threading.Barrier(THREADS)

    def asks(number: int) -> dict[tuple[str, str], str]:
        together.wait()
        order = asked[number:] + asked[:number]
        return {one: ANSWERS[one[1]](shared[one[0]]) for one in order}

    often = sys.getswitchinterval()
    sys.setswitchinterval(1e-4)
    try:
        with ThreadPoolExecutor(THREADS) as threads:
            found = list(threads.map(asks, range(THREADS)))
    finally:
        sys.setswitchinterval(often)
    right = alone(asked)
    for own in found:
        assert [one for one in right if own[one] != right[one]] == []


@pytest.mark.slow
@FEW_OR_ALL
@pytest.mark.parametrize(
    "method",
    [
        pytest.param("fork", marks=pytest.mark.skipif(os.name != "posix", reason="no fork there")),
        pytest.param("spawn", marks=pytest.mark.slow),
    ],
)
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork")
def test_processes(asked: Asked, method: str) -> None:
    """Forked, too, after solvers and linear algebra have run here."""
    right = alone(asked)
    context = multiprocessing.get_context(method)
    with ProcessPoolExecutor(PROCESSES, mp_context=context) as processes:
        found = list(processes.map(answered, *zip(*asked, strict=True), timeout=240))
    assert [one for one, own in zip(asked, found, strict=True) if own != right[one]] == []
