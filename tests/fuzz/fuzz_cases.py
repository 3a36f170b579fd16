"""One case of each kind from its number: what is asked, and of what."""

import json
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from fuzz_conversations import faults_of_call, faults_of_messages
from fuzz_corpus import PRINTED, corpus
from fuzz_mutations import damaged
from fuzz_options import random_words
from fuzz_oracles import (
    faults_of_command,
    faults_of_damaged_proof,
    faults_of_loading,
    faults_of_proof,
    faults_of_sample,
    faults_of_scene,
    said,
)
from fuzz_samples import samples
from fuzz_scenes import random_scene

EFFORT = 0.2
"""For what friction guarantees: counted work, so that cases take milliseconds."""
COMMANDS = ("check", "check", "check", "contacts", "orient", "region")
PROVING = ("check", "check", "check", "region", "margin", "plan", "hold", "transport", "settle")
Random = np.random.Generator
Outcome = tuple[str, list[str]]


def case(kind: str, number: int, folder: Path) -> Outcome:
    """How a case ended, and what is wrong with that."""
    return _KINDS[kind](np.random.default_rng([list(_KINDS).index(kind), number]), number, folder)


def _file(rng: Random, number: int, folder: Path) -> Outcome:
    """A damaged file: asked by a command, loaded, or judged with its proof verified."""
    names = sorted(corpus())
    name = names[number % len(names)]
    path = folder / name
    path.write_bytes(damaged(name, corpus()[name], rng))
    chance = rng.random()
    if chance < 0.4:
        return _of(name, faults_of_loading(path, EFFORT))
    words = _words(str(rng.choice(COMMANDS)) if chance > 0.6 else "check", path)
    if chance < 0.6:
        return _of(name, faults_of_proof(words, folder / "proof.json"))
    return _of(name, faults_of_sample(words, folder))


def _of(name: str, outcome: Outcome) -> Outcome:
    """The outcome with the format of its file, so that cases are counted by format."""
    return f"{name.partition('.')[2]}: {outcome[0]}", outcome[1]


def _format(rng: Random, number: int, folder: Path) -> Outcome:
    """A damaged file of any format that a command reads, in a folder of its own."""
    names = [name for name, sample in samples().items() for _ in range(sample.share)]
    name = names[number % len(names)]
    sample, place = samples()[name], folder / "sample"
    shutil.rmtree(place, ignore_errors=True)
    for file, content in sample.files.items():
        (place / file).parent.mkdir(parents=True, exist_ok=True)
        changed = damaged(file, content, rng) if file == sample.damaged else content
        (place / file).write_bytes(changed)
    command = sample.commands[int(rng.integers(len(sample.commands)))]
    how, found = faults_of_sample(command.format(folder=place).split(), place)
    return f"{name}: {how}", found


def _messages(rng: Random, number: int, folder: Path) -> Outcome:
    """Damaged messages to a workbench."""
    return faults_of_messages(rng)


def _tool(rng: Random, number: int, folder: Path) -> Outcome:
    """A damaged call of a tool of the server for agents."""
    return faults_of_call(rng, number, folder)


def _words(command: str, path: Path) -> list[str]:
    """A command about a file; of those that hold nothing, on a floor."""
    words = [command, str(path), "--quiet"]
    if command != "contacts" and not path.name.endswith(("kilter.json", "urdf", "xml")):
        words.append("--floor")
    if command not in ("contacts", "orient", "region"):
        words += ["--effort", str(EFFORT)]
    return words


def _scene(rng: Random, number: int, folder: Path) -> Outcome:
    return faults_of_scene(random_scene(rng), rng, EFFORT)


def _options(rng: Random, number: int, folder: Path) -> Outcome:
    """A whole file, asked with options at random."""
    whole = [name for name in sorted(corpus()) if name not in PRINTED]
    path = folder / str(rng.choice(whole))
    path.write_bytes(corpus()[path.name])
    command, *more = random_words(rng, folder)
    return faults_of_command([*_words(command, path), *more])


def _proof(rng: Random, number: int, folder: Path) -> Outcome:
    """A damaged proof of a whole file."""
    proofs = whole_proofs(folder)
    name, command = sorted(proofs)[number % len(proofs)]
    path = folder / name
    path.write_bytes(corpus()[name])
    proof = folder / "damaged.proof.json"
    proof.write_bytes(damaged(proof.name, proofs[name, command], rng))
    verdict = str(json.loads(proofs[name, command]).get("verdict", ""))
    how, found = faults_of_damaged_proof(path, proof, verdict)
    return f"{command}: {how}", found


@cache
def whole_proofs(folder: Path) -> dict[tuple[str, str], bytes]:
    """Proofs of commands about small whole files, by file and command."""
    found = {}
    for name in ("paper-figure-8.kilter.json", "tower.kilter.json", "slope.kilter.json"):
        for command in dict.fromkeys(PROVING):
            path, proof = folder / name, folder / "whole.proof.json"
            path.write_bytes(corpus()[name])
            proof.unlink(missing_ok=True)
            said([*_words(command, path), "--proof", str(proof)])
            if proof.exists():
                found[name, command] = proof.read_bytes()
    return found


_KINDS: dict[str, Callable[[Random, int, Path], Outcome]] = {
    "files": _file,
    "scenes": _scene,
    "options": _options,
    "proofs": _proof,
    "formats": _format,
    "messages": _messages,
    "tools": _tool,
}
KINDS = tuple(_KINDS)
