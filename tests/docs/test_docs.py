"""Pages of the documentation run, and are those that their programs write."""

import json
import re
import shlex
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import declared_of
from kilter.cli.option_parser import with_values
from kilter.scenes import scene
from kilter.scenes.walls import wall

sys.path.insert(0, str(Path(__file__).resolve().parent))

from page_runner import SERVES, is_shown, run_page

ROOT = Path(__file__).resolve().parents[2]
SIMULATED = """<mujoco><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body name="box" pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
</worldbody></mujoco>
"""
"""A box on a floor, for MuJoCo."""
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.S)


@pytest.mark.quick("choices.md")
@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_a_page_runs_and_shows_its_answers(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if page.name == "README.md":
        pytest.skip("its commands run in the tests below, on the files of a clone")
    counts = run_page(page)
    if counts.missing:
        pytest.skip(f"{counts.missing} is not here")


@pytest.mark.parametrize(
    ("shown", "right"),
    [
        (["a", "b"], True), (["b"], False), (["...", "b"], True), (["a", "...", "c"], True),
        (["a", "c"], False), (["a", "b", "c", "d"], False), (["...", "c", "b"], False),
    ],
)  # fmt: skip
def test_shown_lines_are_compared(shown, right):
    assert is_shown(["a", "b", "c"], shown) is right


def test_a_wrong_answer_of_a_page_is_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = tmp_path / "page.md"
    written = '```json title="c.txt"\n1x1 (0,0,0)\n```\n'
    page.write_text(written + "```text\n$ kilter example tower -o t.kilter.json\n```\n")
    assert run_page(page).commands == 1
    assert (tmp_path / "c.txt").read_text(encoding="utf-8") == "1x1 (0,0,0)\n"
    page.write_text("```text\n$ kilter check t.kilter.json\nUnstable.\n```\n")
    with pytest.raises(AssertionError, match="Stable"):
        run_page(page)
    page.write_text("```sh\nkilter check none.kilter.json\n```\n")
    with pytest.raises(AssertionError, match=": 2"):
        run_page(page)
    page.write_text("```python\nassert False\n```\n")
    with pytest.raises(AssertionError):
        run_page(page)


@pytest.mark.quick(1)
@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_commands_of_a_page_exist_with_their_flags(page):
    text = page.read_text(encoding="utf-8")
    # a sentence may begin with the name of the program: only lines of code blocks are commands
    typed = [
        line for block in re.findall(r"```.*?```", text, flags=re.S) for line in block.splitlines()
    ]
    quoted = re.findall(r"`kilter [^`\n]+`", text)
    for line in [*typed, *quoted]:
        for words in named_commands(line):
            if words[0].startswith("--"):
                continue  # an option of the program
            assert words[0] in COMMANDS, f"{page.name}: no command {words[0]!r}"
            [function] = functions_of(words[0])
            flags = {
                name: each for each in declared_of(function) for name in each.declaration.names
            }
            typed = with_values(words, flags)
            named = {w.split("=")[0] for w in typed if re.match(r"--?[a-z]", w)}
            assert named <= {*flags, "--help"}, f"{page.name}: {named - {*flags}}"


def named_commands(line: str) -> list[list[str]]:
    found = []
    if line.startswith(("kilter ", "$ kilter ")):
        found.append(re.split(r" {3,}", line.removeprefix("$ "))[0])
    found += re.findall(r"`(kilter [^`]+)`", line) + re.findall(r"bin/(kilter [^&]+)", line)
    return [shlex.split(text)[1:] for text in found if not text.startswith("kilter.")]


@pytest.fixture
def assemblies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What the README's list of commands is about: a wall, a folder of meshes, the examples."""
    from kilter.files import to_text
    from kilter.scenes import scene

    monkeypatch.chdir(tmp_path)
    (tmp_path / "wall.kilter.json").write_text(to_text(scene("wall")), encoding="utf-8")
    (tmp_path / "scene.xml").write_text(SIMULATED, encoding="utf-8")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    (tmp_path / "parts").mkdir()
    for name, height in (("base", 0.0), ("block", 1.0)):
        corners = [(x, y, height + z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
        lines = [f"v {x} {y} {z}" for x, y, z in corners]
        lines += ["f " + " ".join(map(str, face)) for face in faces]
        (tmp_path / "parts" / f"{name}.obj").write_text("\n".join(lines), encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_every_command_that_the_readme_lists_runs(assemblies, capsys):
    listed = [
        line
        for block in blocks(ROOT / "README.md", "text")
        for line in block.splitlines()
        if line.startswith("kilter ")
    ]
    assert len(listed) > 5
    for line in listed:
        [words] = named_commands(line)
        if words[0] in SERVES:
            continue
        code = main(words)
        assert code in (0, 1, 3), f"{line}: {capsys.readouterr().err}"


def test_a_page_that_names_a_missing_flag_fails(tmp_path):
    page = tmp_path / "new.md"
    typed = "```sh\nkilter draw FILE --colour red\n```"
    for line in (typed, "see `kilter draw FILE --colour red`"):
        page.write_text(line + "\n", encoding="utf-8")
        with pytest.raises(AssertionError, match="--colour"):
            test_commands_of_a_page_exist_with_their_flags(page)
    page.write_text("```text\nkilter paint FILE\n```\n", encoding="utf-8")
    with pytest.raises(AssertionError, match="no command 'paint'"):
        test_commands_of_a_page_exist_with_their_flags(page)


def test_each_key_of_an_answer_is_explained():
    text = (ROOT / "docs" / "reference/answers.md").read_text(encoding="utf-8")
    [table] = re.findall(r"\| key of `check --json` \|.*?\n\n", text, flags=re.S)
    cells = " ".join(re.findall(r"^\| (`.*?) \|", table, flags=re.M))
    named = re.findall(r"`(\w+)`", cells)
    assert sorted(named) == sorted(kilter.check(kilter.example("tower")).to_dict())


def test_every_page_is_in_the_site():
    nav = re.findall(r"([\w/-]+\.md)", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    docs = ROOT / "docs"
    pages = {p.relative_to(docs).as_posix() for p in docs.rglob("*.md")}
    authors = {name for name in pages if name.startswith("contributing/")}
    assert sorted(nav) == sorted(pages - authors)
    index = (docs / "contributing/index.md").read_text(encoding="utf-8")
    listed = re.findall(r"\]\(([\w/-]+\.md)\)", index)
    assert sorted(listed) == sorted(n.removeprefix("contributing/") for n in authors
                                    if n != "contributing/index.md")  # fmt: skip


def test_no_page_of_the_site_needs_a_page_for_authors():
    for page in PAGES:
        if "docs" in page.parts and "contributing" not in page.parts:
            assert "](../contributing" not in page.read_text(encoding="utf-8"), page.name


def test_a_picture_of_a_page_is_small():
    for path in (ROOT / "docs" / "images").iterdir():
        assert path.stat().st_size < 150_000, path.name


def test_links_between_pages_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_verdict_shown_in_the_readme_is_what_kilter_says(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    [block] = [b for b in blocks(ROOT / "README.md", "text") if b.startswith("$ kilter check ")]
    shown = block.strip().splitlines()
    main([*shlex.split(shown[0])[2:], "--quiet"])
    said = capsys.readouterr().out.splitlines()
    assert said[: len(shown) - 1] == shown[1:]


@pytest.mark.parametrize(
    "path", sorted((ROOT / "examples").glob("*.kilter.json")), ids=lambda p: p.name
)
def test_an_example_is_what_its_scene_makes(path):
    from kilter.files import to_dict
    from kilter.loading import load
    from kilter.scenes import scene

    made = scene(path.name.removesuffix(".kilter.json"))
    assert to_dict(load(path)) == to_dict(made)


PAGE = (Path(__file__).resolve().parents[2] / "docs/reference/page.md").read_text(encoding="utf-8")


def stated(pattern: str) -> float:
    [number] = re.findall(pattern, PAGE)
    return float(number)


@pytest.mark.slow
def test_a_cell_has_at_least_the_stated_size():
    cell = kilter.check(scene("tower")).show()
    least = stated(r"stored in the notebook \(([\d.]+) MB and more\)")
    assert least <= len(cell._repr_html_().encode()) / 1e6 < least + 0.1


@pytest.mark.slow
def test_a_page_of_ten_thousand_bricks_has_the_stated_size():
    page = kilter.report(wall(100, 100)).html
    size = stated(r"A page of 10,000 bricks has ([\d.]+) MB")
    assert len(page.encode()) / 1e6 == pytest.approx(size, rel=0.1)


NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
LARGEST = 100_000
"""Largest notebook [bytes]."""


def cells(path: Path) -> list[dict[str, object]]:
    return json.loads(path.read_text(encoding="utf-8"))["cells"]  # type: ignore[no-any-return]


def test_there_are_three_notebooks_and_that_of_the_paper():
    names = {path.stem for path in NOTEBOOKS}
    assert names == {"arch_of_compas", "cad_assembly", "mujoco_scene", "paper_figures"}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_complete(path):
    assert path.stat().st_size < LARGEST
    first, *others = cells(path)
    assert "".join(first["source"]).startswith("# ")  # type: ignore[arg-type]
    assert 'pip install "kilter[' in "".join(first["source"])  # type: ignore[arg-type]
    code = [cell for cell in others if cell["cell_type"] == "code"]
    assert all(cell["execution_count"] is None for cell in code)
    outputs = [output for cell in code for output in cell["outputs"]]  # type: ignore[attr-defined]
    assert not [output for output in outputs if output["output_type"] == "error"]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert str(ROOT) not in json.dumps(outputs)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_prints_the_kept_text(path, monkeypatch):
    pytest.importorskip("nbclient", reason="pip install 'kilter[notebook]'")
    pytest.importorskip("ipykernel", reason="pip install 'kilter[notebook]'")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    if path.stem == "arch_of_compas":
        pytest.importorskip("compas_dem", reason="pip install 'kilter[compas]'")
    if path.stem == "mujoco_scene":
        pytest.importorskip("mujoco", reason="pip install 'kilter[mujoco]'")
    monkeypatch.syspath_prepend(ROOT / "docs")
    from run_notebooks import main

    monkeypatch.setattr(sys, "argv", ["run_notebooks.py", "--compare", path.stem])
    assert main() == 0


EXAMPLE = ROOT / "examples" / "clamp.step"


@pytest.fixture
def clamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A base, an arm with a hole on it, a bolt in the hole and a nut round the bolt."""
    pytest.importorskip("OCP", reason="needs the extra kilter[step]")
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "files"))
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from step_maker import write_step

    def cylinder(radius: float, low: float, high: float) -> object:
        axis = gp_Ax2(gp_Pnt(0, 0, low), gp_Dir(0, 0, 1))
        return BRepPrimAPI_MakeCylinder(axis, radius, high - low).Shape()

    def box(low: tuple[float, ...], high: tuple[float, ...]) -> object:
        return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()

    shaft = cylinder(4, 0, 40)
    arm = BRepAlgoAPI_Cut(box((-10, -10, 0), (60, 10, 10)), shaft).Shape()
    nut = BRepAlgoAPI_Cut(cylinder(7, 10, 16), shaft).Shape()
    roots = [("base", box((-30, -30, -10), (70, 30, 0)), None), ("arm", arm, None)]
    return write_step(tmp_path / "clamp.step", [*roots, ("bolt", shaft, None), ("nut", nut, None)])


@pytest.mark.slow
def test_the_example_is_what_is_made_here(clamp):
    made, kept = (kilter.load(path, ground="base") for path in (clamp, EXAMPLE))
    assert made.names == kept.names
    for name in ("volume", "center", "inertia"):
        assert np.array_equal(getattr(made.geometry, name), getattr(kept.geometry, name))
    assert kilter.check(kept).stable


@pytest.mark.slow
def test_the_command_of_the_page_puts_the_nut_over_its_bolt(clamp, monkeypatch, capsys):
    monkeypatch.chdir(clamp.parent)
    page = (ROOT / "docs" / "guides/order.md").read_text(encoding="utf-8")
    [line] = re.findall(r"^\$ kilter (plan clamp\.step .*)$", page, flags=re.M)
    words = [*shlex.split(line), "-o", "clamp.html"]
    shutil.copy(EXAMPLE, clamp)
    assert main(words) == 0, capsys.readouterr().err
    assert (clamp.parent / "clamp.html").stat().st_size > 1e5
    capsys.readouterr()
    assert main([*words[: words.index("-o")], "--json"]) == 0
    steps = json.loads(capsys.readouterr().out)["steps"]
    assert [step["parts"] for step in steps][-1] == ["nut"]
    assert (steps[-1]["over"], steps[-1]["direction"]) == ("bolt", [0, 0, -1])
    # without the word about the thread the nut is a ring that comes along any way that is free
    screws = words.index("--screws")
    assert main([*words[:screws], *words[screws + 3 : words.index("-o")], "--json"]) == 0
    assert all(step["over"] is None for step in json.loads(capsys.readouterr().out)["steps"])
