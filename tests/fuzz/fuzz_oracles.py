"""What must hold of every run, whatever it was given; each function gives the faults it sees."""

from __future__ import annotations

import contextlib
import io
import json
import re
import warnings
from pathlib import Path

import numpy as np

import kilter
from kilter import Assembly
from kilter.cli import main
from kilter.scenes.transform import moved, permuted, renamed, scaled

ANSWERS = {0, 1, 3, 4}
DECIDED = {"stable", "unstable"}


def said(words: list[str]) -> tuple[int, str, str]:
    """Exit code, output and error stream of a command, run in this process."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            code = main(words)
        except SystemExit as ended:
            code = int(ended.code or 0)
    return code, out.getvalue(), error.getvalue()


def faults_of_command(words: list[str]) -> list[str]:
    """An answer or one line that says what is wrong; never a traceback, a warning, exit 70."""
    code, _, error = said([*words, "--json"])
    found = []
    if code not in ANSWERS | {2}:
        found.append(f"exit {code}: {error.strip()[:300]}")
    if "Traceback" in error or re.search(r"\w+Warning\b", error):
        found.append(f"on the error stream: {error.strip()[:300]}")
    if code == 2 and (error.count("\n") != 1 or not error.startswith("kilter: ")):
        found.append(f"exit 2 with {error.count(chr(10))} lines: {error.strip()[:300]}")
    if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", error):
        found.append(f"control characters on the error stream: {error!r:.300}")
    return found


def faults_of_proof(words: list[str], proof: Path) -> list[str]:
    """A proof that a check wrote holds when it is verified."""
    proof.unlink(missing_ok=True)
    code, out, _ = said([*words, "--json", "--proof", str(proof)])
    if code not in ANSWERS or not proof.exists():
        return []
    verified, _, error = said(["verify", words[1], str(proof)])
    if verified == 0:
        return []
    verdict = json.loads(out)["verdict"]
    return [f"proof of {verdict} refused: exit {verified} {error.strip()[:200]}"]


def faults_of_scene(assembly: Assembly, rng: np.random.Generator, effort: float) -> list[str]:
    """A verdict or an `InputError`; the same one renamed, permuted, turned and scaled."""
    found: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            verdict = kilter.check(assembly, effort=effort).verdict
        except kilter.InputError:
            return []
        except Warning as warning:
            return [f"a warning of {warning!r}"]
        for way, other in _others(assembly, rng):
            try:
                again = kilter.check(other, effort=effort).verdict
            except kilter.InputError as error:
                found.append(f"{way}: refused, {error}")
                continue
            if {verdict, again} == DECIDED:
                found.append(f"{way}: {verdict} became {again}")
    return found


def _others(assembly: Assembly, rng: np.random.Generator) -> list[tuple[str, Assembly]]:
    """The same assembly in other words."""
    turn = rng.normal(size=4)
    pose = kilter.Pose(rng.normal(size=3), turn / np.linalg.norm(turn))
    return [
        ("renamed", renamed(assembly, lambda name: f"x-{name}")),
        ("permuted", permuted(assembly, rng.permutation(len(assembly.parts)).tolist())),
        ("turned", moved(assembly, pose.rotation, pose.position)),
        ("scaled", scaled(assembly, float(10.0 ** rng.uniform(-3, 3)))),
    ]
