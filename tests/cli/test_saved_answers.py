"""Options and a saved file give the same JSON: commands of the docs, and random options."""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.cli.commands import functions_of
from kilter.cli.declarations import declared_in, declared_of
from kilter.cli.option_parser import with_values
from kilter.cli.options import AddedOptions
from kilter.cli.tolerance_options import ToleranceOptions
from kilter.errors import KilterError
from kilter.files.choices_off import OFF
from kilter.files.reading_options import ReadingOptions
from kilter.shape.primitives import BOX_CORNERS, BOX_QUADS

RECORDS = (ReadingOptions, AddedOptions, ToleranceOptions)
READING = [each.name for record in RECORDS for each in declared_in(record)]

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
VERBS = ("check", "contacts", "orient", "region", "margin", "plan", "hold", "improve", "transport")
PICTURES = ("report", "draw")
"""Verbs that write a page or a picture, which is compared in place of JSON."""
LONGEST = 30
SETS, EACH = 48, 6
FLAGS = {"--loose", "--fasten-suggested", "--fasten-overlaps"}
QUESTIONS = {"mass", "load", "accelerate"}
"""Shared options that choices do not keep."""
OPTIONS = {f"--{name.replace('_', '-')}" for name in READING if name not in QUESTIONS}
WRITES = ("-o", "--output", "--write", "--proof")


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


# commands of the docs -------------------------------------------------------------------


def documented() -> list[tuple[str, ...]]:
    """The longest commands of the pages that answer about a single file."""
    commands: set[tuple[str, ...]] = set()
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        blocks = re.findall(r"```.*?```", text, flags=re.S)
        lines = [line.removeprefix("$ ") for block in blocks for line in block.splitlines()]
        typed = [re.split(r" {3,}", line)[0] for line in lines if line.startswith(("kilter", "$"))]
        for line in [*typed, *re.findall(r"`(kilter [^`\n]+)`", text)]:
            words = tuple(shlex.split(line)[1:])
            if words[:1] and words[0] in (*VERBS, *PICTURES) and "--common" not in words:
                commands.add(words)
    runnable = [words for words in commands if file_of(words) is not None]
    return sorted(runnable, key=lambda words: (-len(" ".join(words)), words))[:LONGEST]


def file_of(words: tuple[str, ...]) -> str | None:
    """The file of a command that an example or the folder of examples supplies."""
    names = {entry.name for entry in kilter.example()}
    for word in words[1:]:
        if word.removesuffix(".kilter.json") in names and word.endswith(".kilter.json"):
            return word
        if word.startswith("examples/") and (ROOT / word).exists():
            return word
    return None


def split(words: list[str]) -> tuple[list[str], list[str]]:
    """Options of reading, and all other words without files to write."""
    [check] = functions_of("check")
    known = {name: each for each in declared_of(check) for name in each.declaration.names}
    rest = iter(with_values(words, known))
    reading: list[str] = []
    others: list[str] = []
    for word in rest:
        name = word.split("=")[0]
        if name in WRITES:
            next(rest)
        elif name not in OPTIONS:
            others.append(word)
        elif name in FLAGS or "=" in word:
            reading.append(word)
        else:
            reading += [word, *(next(rest) for _ in known[name].kinds)]
    return reading, others


@pytest.mark.quick(1)
@pytest.mark.parametrize("k", range(LONGEST))
def test_a_command_of_the_docs_answers_the_same_about_saved_options(
    k: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = documented()[k]
    if "clamp.step" in " ".join(words):
        pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    file = file_of(words)
    assert file is not None
    if file.startswith("examples/"):
        shutil.copytree(ROOT / "examples", "examples")
    else:
        kilter.dump(kilter.example(file.removesuffix(".kilter.json")), file)
    reading, others = split([word for word in words[1:] if word != file])
    choices = "saved.json"
    saved = run(["save", file, *reading, "-o", choices])
    assert saved[0] == 0, saved[2]
    code, answer = answer_of(words, [file, *reading, *others])
    assert code in (0, 1, 3, 4), answer
    assert answer_of(words, [choices, *others]) == (code, answer)


def answer_of(words: tuple[str, ...], request: list[str]) -> tuple[int, Any]:
    """Exit code, and the JSON or the written picture, of a verb with other words after it."""
    verb = words[0]
    if verb in VERBS:
        code, out, err = run([verb, *request, "--json"])
        return code, timeless(json.loads(out)) if out else err
    target = Path("picture" + Path(words[words.index("-o") + 1]).suffix)
    target.unlink(missing_ok=True)
    code, _, err = run([verb, *request, "-o", str(target)])
    assert code == 0, err
    picture = target.read_bytes()
    if target.suffix != ".html":
        return code, picture
    # the page states its file and the command that wrote it
    [name] = re.findall(rb"<title>(.*?) \xe2\x80\x93 kilter</title>", picture)
    heading = b'<bdi id="title">' + name + b"</bdi>"
    for stated in (b"<title>" + name, heading, b'"title":"' + name + b'"'):
        assert picture.count(stated) == 1
        picture = picture.replace(stated, b"")
    page, commands = re.subn(rb"kilter report [^<]*</code>", b"", picture)
    assert commands == 1
    return code, page


def test_the_commands_of_the_docs_include_pictures_and_carriers() -> None:
    assert {"report", "draw", "transport"} <= {words[0] for words in documented()}


def test_the_docs_have_enough_long_commands() -> None:
    commands = documented()
    assert len(commands) == LONGEST
    assert sum(bool(split(list(words))[0]) for words in commands) >= 8


# random options -------------------------------------------------------------------------


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
