"""The golden census: each built-in example, asked by each command, as JSON and as text.

    python benchmarks/golden_census.py REVISION          compare with another revision
    python benchmarks/golden_census.py --write F.jsonl   write the answers of this revision
    python benchmarks/golden_census.py A.jsonl B.jsonl   compare two files of answers

`--only check margin` asks these commands alone, `--examples arch tower` these examples alone. Exit
codes, words and values are compared; numbers to 1e-9, seconds not at all. Each difference is
printed, then a count for each command and key. The exit code is 1 if there is any.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import difflib
import io
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

for _pool in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_pool] = "1"  # before numpy

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = {
    "check": ["--proof", "proof.json"],
    "verify": ["proof.json"],
    "contacts": [],
    "scene": [],
    "orient": [],
    "region": [],
    "margin": ["--improve"],
    "transport": [],
    "plan": [],
    "hold": [],
    "settle": [],
    "place": ["--box", ".2x.2x.2", "--mass", "1"],
}
"""Words after the file name, by command. `verify` reads the proof that `check` wrote."""
AGREES = 1e-9
"""Largest difference of two equal numbers, absolute and relative."""
SECONDS = re.compile(r"\d[\d.]* ?(?:s|ms)\b")

Answer = dict[str, Any]


def answers(commands: list[str], examples: list[str]) -> Iterator[Answer]:
    """The answers of this revision, each with `example`, `command`, `form`, `exit` and `out`."""
    from kilter import dump
    from kilter.scenes import SCENES, scene

    for name in examples or list(SCENES):
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            file = f"{name}.kilter.json"
            dump(scene(name), file)
            for command in commands:
                for form in ("json", "text"):
                    words = [command, file, *COMMANDS[command], *(["--json"] * (form == "json"))]
                    code, out = _called(words)
                    yield {
                        "example": name,
                        "command": command,
                        "form": form,
                        "exit": code,
                        "out": out,
                    }


def _called(words: list[str]) -> tuple[int, str]:
    """Exit code and output of a command, with its errors if it wrote nothing else."""
    from kilter.cli import main

    out, errors, argv = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["kilter", *words]
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
            code = main()
    except SystemExit as stopped:
        code = stopped.code
    finally:
        sys.argv = argv
    return int(code or 0), out.getvalue() or errors.getvalue()


def differences(old: Answer, new: Answer) -> Iterator[tuple[str, str]]:
    """Keys (or "text") whose values differ, each with the old and the new value."""
    if old["exit"] != new["exit"]:
        yield "exit", f"{old['exit']} -> {new['exit']}"
    if old["form"] == "json":
        with contextlib.suppress(ValueError):
            yield from _differing("", json.loads(old["out"]), json.loads(new["out"]))
            return
    lines = difflib.unified_diff(
        *(SECONDS.sub("# s", one["out"]).splitlines() for one in (old, new)), lineterm="", n=0
    )
    changed = [line for line in lines if not line.startswith(("---", "+++", "@@"))]
    if changed:
        yield "text", "\n    ".join(changed)


def _differing(path: str, old: Any, new: Any) -> Iterator[tuple[str, str]]:
    """The places where two values of JSON differ; numbers of places are left out of their names."""
    if path == ".seconds":
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in {**old, **new}:
            yield from _differing(f"{path}.{key}", old.get(key, "-"), new.get(key, "-"))
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for one, other in zip(old, new, strict=True):
            yield from _differing(f"{path}[]", one, other)
    elif isinstance(old, float) and isinstance(new, (float, int)):
        if not math.isclose(old, new, rel_tol=AGREES, abs_tol=AGREES):
            yield path, f"{old} -> {new}"
    elif old != new:
        yield path, f"{json.dumps(old)[:200]} -> {json.dumps(new)[:200]}"


def compared(old: Path, new: Path) -> int:
    """Print the differences of two files of answers, and return how many answers differ."""
    before, after = ({_key(one): one for one in _lines(file)} for file in (old, new))
    counts: collections.Counter[str] = collections.Counter()
    differing = 0
    for key in [key for key in {**before, **after} if not (key in before and key in after)]:
        differing += 1
        print(*key, "is only in", old if key in before else new)
    for key in (key for key in before if key in after):
        found = list(differences(before[key], after[key]))
        differing += bool(found)
        for place, change in found:
            counts[f"{key[1]} {place}"] += 1
            print(f"{' '.join(key)} {place}: {change}")
    print(f"\n{len(before)} answers, {differing} differ")
    for place, count in counts.most_common():
        print(f"{count:6d}  {place}")
    return differing


def _key(one: Answer) -> tuple[str, str, str]:
    return one["example"], one["command"], one["form"]


def _lines(file: Path) -> list[Answer]:
    return [json.loads(line) for line in file.read_text().splitlines()]


def written_by(revision: str, into: Path, asked: list[str]) -> Path:
    """A file with the answers of a revision of this repository."""
    source = into / "source"
    source.mkdir()
    archive = subprocess.run(
        ["git", "archive", revision, "src"], cwd=ROOT, capture_output=True, check=True
    )
    subprocess.run(["tar", "-x"], cwd=source, input=archive.stdout, check=True)
    return _written(source / "src", into / "old.jsonl", asked)


def _written(source: Path, file: Path, asked: list[str]) -> Path:
    words = [sys.executable, __file__, "--write", str(file), *asked]
    subprocess.run(words, env={**os.environ, "PYTHONPATH": str(source)}, check=True)
    return file


def main() -> int:
    """Write or compare answers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("of", nargs="*", help="a revision, or two files of answers")
    parser.add_argument("--write", type=Path, help="write the answers of this revision")
    parser.add_argument("--only", nargs="+", choices=list(COMMANDS), default=list(COMMANDS))
    parser.add_argument("--examples", nargs="+", default=[])
    given = parser.parse_args()
    if given.write:
        with given.write.open("w") as file:
            for one in answers(given.only, given.examples):
                file.write(json.dumps(one) + "\n")
                file.flush()
        return 0
    if len(given.of) == 2:
        return min(compared(*map(Path, given.of)), 1)
    asked = ["--only", *given.only, *(["--examples", *given.examples] if given.examples else [])]
    with tempfile.TemporaryDirectory() as folder:
        old = written_by(given.of[0] if given.of else "HEAD", Path(folder), asked)
        new = _written(ROOT / "src", Path(folder) / "new.jsonl", asked)
        return min(compared(old, new), 1)


if __name__ == "__main__":
    sys.exit(main())
