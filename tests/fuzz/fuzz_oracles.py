"""What must hold of every run, whatever it was given: how it ended, and the faults of that."""

from __future__ import annotations

import contextlib
import io
import json
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import kilter
from kilter import Assembly
from kilter.cli import main
from kilter.errors import LONGEST_MESSAGE, NO_MEMORY
from kilter.scenes.pieces import moved

sys.path.append(str(Path(__file__).parents[1] / "scenes"))  # run as a command, without pytest

from transformations import permuted, renamed, scaled

ANSWERS = {0, 1, 3, 4}
DECIDED = {"stable", "unstable"}
STANDS = {"stable", "settles", "potentially-stable"}
"""Verdicts that have forces of equilibrium, of which there are none where it is unstable."""
APART, ROUGH, THIN = 1e6, 1e3, 1e4
"""Masses, friction and sizes that leave a solver few of its sixteen digits."""
LONGEST_SENTENCE, LONGEST_ERROR = LONGEST_MESSAGE + 10, 50_000
"""Largest number of characters of an error, and of an error with warnings."""
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
"""What moves the cursor of a terminal, colours it, or turns its writing."""
Outcome = tuple[str, list[str]]


def said(words: list[str]) -> tuple[int, str, str]:
    """Exit code, output and error stream of a command, run in this process."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            code = main(words)
        except SystemExit as ended:
            code = int(ended.code or 0)
    return code, out.getvalue(), error.getvalue()


def faults_of_command(words: list[str]) -> Outcome:
    """An answer or one line that says what is wrong; never a traceback, a warning, exit 70."""
    code, out, error = said(words)
    return f"exit {code}", _wrong_with(code, out, error)


def _wrong_with(code: int, out: str, error: str) -> list[str]:
    found = []
    if NO_MEMORY in error:
        found.append("takes too much memory")
    if code not in ANSWERS | {2}:
        found.append(f"exit {code}: {error.strip()[:300]}")
    if "Traceback" in error or re.search(r"\w+Warning\b", error):
        found.append(f"on the error stream: {error.strip()[:300]}")
    if code == 2 and (error.count("\n") != 1 or not error.startswith("kilter: ")):
        found.append(f"exit 2 with {error.count(chr(10))} lines: {error.strip()[:300]}")
    strange = [line for line in error.splitlines() if line and not line.startswith("kilter: ")]
    if strange:
        found.append(f"not a sentence of kilter on the error stream: {strange[0][:300]}")
    if len(error) > LONGEST_ERROR or (code == 2 and len(error) > LONGEST_SENTENCE):
        found.append(f"{len(error)} characters on the error stream: {error[:200]}")
    if code == 2 and out:
        found.append(f"exit 2 with an answer: {out[:100]!r}")
    for name, text in (("error stream", error), ("output", out)):
        if seen := CONTROL.search(text):
            start = max(seen.start() - 60, 0)
            found.append(f"a control character on the {name}: {text[start : start + 120]!r}")
    return found


def faults_of_sample(words: list[str], folder: Path) -> Outcome:
    """As of any command; and after an error no file is left in the folder."""
    before = listed(folder)
    how, found = faults_of_command(words)
    left = sorted(listed(folder) - before)
    if left and not (how in ("exit 0", "exit 1") and words[0] == "batch"):
        found.append(f"files are left: {left[:5]}")
    return how, found


def listed(folder: Path) -> set[str]:
    """Paths of all files and folders below a folder."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def faults_of_proof(words: list[str], proof: Path) -> Outcome:
    """As of any command; and the proof that it wrote holds when it is verified."""
    proof.unlink(missing_ok=True)
    code, out, error = said([*words, "--json", "--proof", str(proof)])
    found = _wrong_with(code, "", error)
    if found or code not in ANSWERS or not proof.exists():
        return f"exit {code}", found
    verified, _, error = said(["verify", words[1], str(proof)])
    if verified != 0:
        verdict = json.loads(out)["verdict"]
        found.append(f"proof of {verdict} refused: exit {verified} {error.strip()[:200]}")
    return f"exit {code}, verified", found


def faults_of_damaged_proof(file: Path, proof: Path, verdict: str) -> Outcome:
    """It holds, or not, or is no proof; it does not prove the contrary of what was proved."""
    code, out, error = said(["verify", str(file), str(proof), "--json"])
    found = _wrong_with(code, "", error)
    if code not in (0, 1, 2):
        found.append(f"verify ends with {code}")
    if code == 0 and {verdict, json.loads(out)["verdict"]} == DECIDED:
        found.append(f"of what is {verdict} the contrary is verified")
    return f"exit {code}", found


@contextlib.contextmanager
def _strictly() -> Iterator[None]:
    """Warnings are errors, those of numpy's numbers too."""
    with warnings.catch_warnings(), np.errstate(all="warn", under="ignore"):
        warnings.simplefilter("error")
        yield


def faults_of_loading(path: Path, effort: float) -> Outcome:
    """The same from Python: a verdict or an `InputError`, and no warning."""
    with _strictly():
        try:
            held = not path.name.endswith(("kilter.json", "urdf", "xml"))
            verdict = kilter.check(kilter.load(path, floor=held or None), effort=effort)
        except kilter.InputError:
            return "refused", []
        return verdict.verdict, []


def faults_of_scene(assembly: Callable[[], Assembly], rng: Random, effort: float) -> Outcome:
    """A verdict or an `InputError`; the same one renamed, permuted, turned and scaled.

    All changes are made at once; where the verdict is another one, each by itself, to name it.
    """
    with _strictly():
        try:
            made = assembly()
            first = kilter.check(made, effort=effort)
        except kilter.InputError:
            return "refused", []
        found = _unproved(first, rng)
        verdict, ways = first.verdict, _ways(made, rng)
        again, second = _again(made, list(ways.values()), effort)
        how = verdict if again in ("refused", verdict) else f"{verdict}, again {again}"
        if second is not None and "undecided" in {verdict, again} and again != verdict:
            cause = why_undecided(first, second)
            how = f"{how}: {cause}"
            if not cause:
                found.append(f"{how}{first.sentence} {second.sentence}")
        if not _contrary(verdict, again):
            return how, found
        for name, way in ways.items():
            alone, _ = _again(made, [way], effort)
            if _contrary(verdict, alone):
                found.append(f"{name}: {verdict} became {alone}")
        return how, found or [f"all at once: {verdict} became {again}"]


def _contrary(verdict: str, other: str) -> bool:
    words = {verdict, other}
    return ("unstable" in words and bool(words & STANDS)) or other.startswith("refused: ")


def why_undecided(first: kilter.Verdict, second: kilter.Verdict) -> str:
    """Why one of two answers about a scene is undecided and the other is not; empty: unknown.

    Another pair is open: a gap is at its tolerance, or an open mesh fills another box. Else its
    numbers leave no solver the digits that a proof needs, and what makes them so is named.
    """
    if _open_pairs(first) != _open_pairs(second):
        return "another pair is open"
    return _extreme(first.assembly)


def _open_pairs(answer: kilter.Verdict) -> set[frozenset[str]]:
    """Names of parts, as they were before they had others."""
    names = [name.removeprefix("x-") for name in answer.assembly.names]
    return {frozenset(names[k] for k in pair.ends) for pair in answer.contact_set.open_pairs}


def _extreme(assembly: Assembly) -> str:
    """What of an assembly is far from anything that stands on a table; empty: nothing."""
    geometry = assembly.geometry
    free = [k for k, part in enumerate(assembly.parts) if not part.grounded]
    mass, size = geometry.mass[free], geometry.size
    if mass.max() > APART * mass.min():
        return "masses far apart"
    if assembly.friction > ROUGH / 2:
        return "friction without bound"
    if size.max() > THIN * size.min():
        return "sizes far apart"
    return ""


def _unproved(verdict: kilter.Verdict, rng: Random) -> list[str]:
    """The proof of a verdict, where it is not verified; of every third."""
    if rng.random() > 0.33 or verdict.evidence is None:
        return []
    found = kilter.verify(verdict.assembly, json.loads(json.dumps(verdict.proof())))
    return [] if found.holds else [f"proof of {verdict.verdict} refused: {found.reasons}"[:300]]


def _again(
    assembly: Assembly, ways: list[Callable[[Assembly], Assembly]], effort: float
) -> tuple[str, kilter.Verdict | None]:
    """The verdict after changes, and all of its answer; or why there is none."""
    try:
        for way in ways:
            assembly = way(assembly)
        answer = kilter.check(assembly, effort=effort)
        return answer.verdict, answer
    except kilter.InputError as error:
        # what a scene of 1e-90 m is scaled to may be out of range; nothing else may be refused
        return "refused" if "out of range" in str(error) else f"refused: {error}", None


Random = np.random.Generator


def _ways(assembly: Assembly, rng: Random) -> dict[str, Callable[[Assembly], Assembly]]:
    """The same assembly in other words."""
    turn = rng.normal(size=4)
    turn /= np.linalg.norm(turn)
    size = float(np.ptp(assembly.geometry.center, axis=0).max(initial=0.0)) or 1.0
    shift = rng.normal(size=3) * size
    order = rng.permutation(len(assembly.parts)).tolist()
    factor = float(10.0 ** rng.uniform(-3, 3))
    return {
        "renamed": lambda one: renamed(one, lambda name: f"x-{name}"),
        "permuted": lambda one: permuted(one, order),
        "turned": lambda one: moved(one, turn, shift),
        "scaled": lambda one: scaled(one, factor),
    }
