"""Commands with options at random, sensible and not."""

from pathlib import Path

import numpy as np
from fuzz_corpus import numbers

Random = np.random.Generator

COMMANDS = (*["check"] * 4, "contacts", "orient", "region", "margin", "plan", "hold", "report")
VALUES = {
    "number": ("--friction", "--density", "--gap", "--angle", "--clearance"),
    "name": ("--ground", "--without"),
    "word": ("--units", "--up", "--contacts", "--base", "--keyframe", "--down", "--fasten"),
    "flag": ("--loose", "--json", "--verbose", "--fasten-suggested", "--fasten-overlaps"),
}
NAMES = ("*", "C1", "block", "table", "C?", "[", "", "part*", "\x1b[31m", "ground", "*" * 60 + "a")
WORDS = ("mm", "m", "in", "y", "-z", "file", "geometry", "fixed", "floating", "", "\x00", "ü")
SEARCHES = ("check", "margin", "plan", "hold", "report")


def random_words(rng: Random, folder: Path) -> list[str]:
    """A command, and options of it."""
    command = str(rng.choice(COMMANDS))
    words = [command]
    for _ in range(int(rng.integers(0, 4))):
        kind = str(rng.choice(list(VALUES)))
        option = str(rng.choice(VALUES[kind]))
        if command == "report" and option in ("--json", "--verbose"):
            continue
        words += [option, *_values(option, kind, rng)]
    if command in SEARCHES and rng.random() < 0.3:
        words += ["--time-limit", str(rng.choice(["0", "-1", "nan", "1e-9", "10"]))]
    if command == "check" and rng.random() < 0.3:
        words += ["--require", str(rng.choice(["equilibrium", "proved", "strict", "x"]))]
    if command == "report":
        words += ["-o", str(folder / rng.choice(["out.html", "out.txt", "no/out.html"]))]
    if rng.random() < 0.1:
        words += [f"--floor={numbers(rng)}"]
    return words


def _values(option: str, kind: str, rng: Random) -> list[str]:
    if kind == "flag":
        return []
    if kind == "number":
        return [numbers(rng)]
    if option == "--down":
        return [numbers(rng) for _ in range(3)]
    if option == "--fasten":
        return [str(rng.choice(NAMES)), str(rng.choice(NAMES))]
    return [str(rng.choice(NAMES if kind == "name" else WORDS))]
