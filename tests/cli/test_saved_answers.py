"""Random options and a saved file of them give the same JSON."""

from __future__ import annotations

import contextlib
import io
import json
import shlex
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.errors import KilterError
from kilter.files.choices_off import OFF
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS

ROOT = Path(__file__).resolve().parents[2]
SETS, EACH = 48, 6


def run(words: list[str]) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    return code, out.getvalue(), err.getvalue()


def timeless(answer: Any) -> Any:
    if isinstance(answer, dict):
        return {key: timeless(value) for key, value in answer.items() if key != "seconds"}
    return [timeless(value) for value in answer] if isinstance(answer, list) else answer


def unnoted(text: str) -> Any:
    """Data of an answer without its warnings about replaced choices."""
    answer = timeless(json.loads(text))
    warnings = [words for words in answer["warnings"] if "of the choices" not in words]
    return {**answer, "warnings": warnings}


def write_files(folder: Path) -> dict[str, tuple[str, ...]]:
    """A file of each kind, with the names of its parts."""
    kilter.dump(kilter.example("tower"), folder / "tower.kilter.json")
    kilter.dump(kilter.example("wall", size=(3, 3)), folder / "wall.kilter.json")
    (folder / "bricks.txt").write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n2x2 (5,0,2)\n", "utf-8")
    quads = {str(k): quad for k, quad in enumerate(BOX_QUADS.tolist())}
    nodes = {}
    (folder / "mesh").mkdir()
    for k, shift in enumerate((0.0, 0.2, 0.6)):
        corners = (BOX_CORNERS + np.array([shift, 0, k])).tolist()
        places = {str(n): dict(zip("xyz", x, strict=True)) for n, x in enumerate(corners)}
        data = {"attributes": {}, "vertex": places, "face": quads}
        block = {"dtype": "compas_assembly.datastructures/Block", "data": data}
        nodes[str(k)] = {"block": block, "is_support": k == 0}
        lines = ["v " + " ".join(map(str, x)) for x in corners]
        lines += ["f " + " ".join(str(n + 1) for n in quad) for quad in BOX_QUADS.tolist()]
        (folder / "mesh" / f"m{k}.obj").write_text("\n".join(lines), "utf-8")
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes}}
    kind = "compas_assembly.datastructures/Assembly"
    compas = {"dtype": kind, "data": {"graph": graph}}
    (folder / "compas.json").write_text(json.dumps(compas), "utf-8")
    shutil.copy(ROOT / "examples" / "clamp.step", folder)
    files = ["tower.kilter.json", "wall.kilter.json", "compas.json", "mesh", "bricks.txt"]
    names = {file: kilter.load(folder / file).names for file in files}
    return {**names, "clamp.step": ("base", "arm", "bolt", "nut")}


def random_options(rng: np.random.Generator, file: str, names: tuple[str, ...]) -> list[str]:
    """Random options of reading; a set may be invalid."""
    pick = lambda: str(rng.choice(names))  # noqa: E731
    number = lambda low, high: f"{rng.uniform(low, high):.17g}"  # noqa: E731
    turned = ["--down", *(f"{x:.17g}" for x in [*rng.normal(0, 0.1, 2), -1.0])]
    pattern = f"{pick()[:2]}*"
    options: list[tuple[float, list[str]]] = [
        (0.7, ["--ground", names[0], *([pick()] if rng.random() < 0.3 else [])]),
        (0.3, ["--floor"] if rng.random() < 0.6 else ["--floor", number(-1, 0)]),
        (0.25, ["--without", pattern if rng.random() < 0.3 else pick()]),
        (0.5, turned if rng.random() < 0.7 else ["--up", str(rng.choice(["y", "z", "-x"]))]),
        (0.5, ["--friction", number(0, 1)]),
        (0.3, ["--density", number(100, 8000)]),
        (0.3, ["--fasten", pick(), pattern]),
        (0.2, ["--bond", pick(), pattern, number(0, 100)]),
        (0.2, ["--fasten-suggested"]),
        (0.2, ["--fasten-overlaps"]),
        (0.3, ["--gap", number(1e-6, 1e-2)]),
        (0.2, ["--angle", number(0.01, 3)]),
        (0.2, ["--clearance", number(1e-6, 1e-2)]),
        (0.2, ["--loose"]),
    ]
    if file in ("compas.json", "mesh"):
        options.append((0.4, ["--units", str(rng.choice(["mm", "cm", "in"]))]))
    if file == "compas.json":
        options.append((0.3, ["--contacts", "geometry"]))
    if file == "bricks.txt":
        options += [
            (0.4, ["--stud-pull", number(0, 2)]),
            (0.3, ["--stud-shear", str(rng.choice(["mu", "unlimited", "0.7"]))]),
            (0.3, ["--brick-sides", str(rng.choice(["face", "none"]))]),
        ]
    return [word for chance, words in options if rng.random() < chance for word in words]


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, SETS, EACH))
def test_random_options_answer_the_same_when_they_are_saved(
    first: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = write_files(tmp_path)
    try:
        import OCP  # noqa: F401
    except ModuleNotFoundError:
        del files["clamp.step"]
    answers = 0
    for k in range(first, first + EACH):
        rng = np.random.default_rng([35, k])
        file = list(files)[k % len(files)]
        words = random_options(rng, file, files[file])
        given = run(["check", file, *words, "--effort", "0", "--json"])
        saved = run(["save", file, *words, "-o", "saved.json", "--quiet"])
        line = shlex.join([file, *words])
        if saved[0] == 2:
            assert given[0] == 2, line
            assert saved[2] == given[2].replace("check", "save"), line
            continue
        code, out, err = run(["check", "saved.json", "--effort", "0", "--json"])
        assert code == given[0], (line, err, given[2])
        assert err == given[2], line
        if code != 2:
            answers += 1
            assert timeless(json.loads(out)) == timeless(json.loads(given[1])), line
        plain = run(["check", file, "--effort", "0", "--json"])
        code, bare, _ = run(["check", "saved.json", "--off", *OFF, "--effort", "0", "--json"])
        assert code == plain[0], line
        assert not bare or unnoted(bare) == unnoted(plain[1]), line
        choices = kilter.Choices.read("saved.json")
        run(["save", "saved.json", "-o", "again.json", "--quiet"])
        assert kilter.Choices.read("again.json") == choices, line
        with contextlib.suppress(KilterError):
            verdict = kilter.check(kilter.load("saved.json"), effort=0)
            assert timeless(verdict.to_dict()) == timeless(json.loads(out)), line
    assert answers >= 1
