"""`kilter plan`: exit codes, what is written, and that `verify` recomputes it."""

import json
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.scenes import scene
from kilter.scenes.arches import arch


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "arch.kilter.json"
    kilter.dump(arch(9, ratio=0.3, friction=0.6), path)
    return path


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("options", "code"),
    [
        ([], 0),
        (["--hold", "0"], 1),
        (["--effort", "0"], 4),
        (["--require", "proved", "--effort", "0.1"], 3),
        (["--never-hold", "voussoir*"], 1),
        (["--directions", "0,0,-1"], 4),
        (["--before", "voussoir-1", "voussoir-0", "--before", "voussoir-0", "voussoir-1"], 2),
        (["--before", "voussoir-1", "nobody"], 2),
        (["--directions", "up"], 2),
        (["--screws", "voussoir-1"], 2),
        (["--ground", "*"], 0),
        (["--friction", "0.1"], 1),
    ],
)
def test_exit_codes(file, options, code):
    assert main(["plan", str(file), *options]) == code


@pytest.mark.slow
def test_the_proof_is_verified_from_the_file(file, tmp_path, capsys):
    proof = tmp_path / "p.json"
    assert main(["plan", str(file), "--proof", str(proof), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["found"], answer["holds_max"], answer["impossible"]["kind"]) == (
        True, 1, "closure",
    )  # fmt: skip
    assert main(["verify", str(file), str(proof)]) == 0
    assert "The proof holds: plan." in capsys.readouterr().out
    data = json.loads(proof.read_text())
    step = next(one for one in data["proofs"] if one["about"] == "step" and one["change"]["held"])
    step["proof"]["forces"][0][2] += 1e4
    proof.write_text(json.dumps(data))
    assert main(["verify", str(file), str(proof)]) == 1


@pytest.mark.slow
def test_steps_are_written_as_a_table(file, tmp_path):
    table = tmp_path / "plan.csv"
    assert main(["plan", str(file), "-o", str(table)]) == 0
    lines = table.read_text().splitlines()
    assert lines[0].startswith("step,part,held")
    assert len(lines) == 10


@pytest.mark.slow
def test_what_falls_when_it_is_finished_is_named(file, capsys):
    assert main(["plan", str(file), "--friction", "0.1"]) == 1
    said = capsys.readouterr().out
    assert "the finished assembly falls: 'voussoir-" in said


@pytest.mark.slow
def test_a_page_is_written_that_says_how_it_was_made(file, tmp_path, capsys):
    page = tmp_path / "plan.html"
    options = ["--hold", "1", "--before", "voussoir-8", "voussoir-0"]
    assert main(["plan", str(file), *options, "-o", str(page)]) == 0
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith(f"{page}: ")
    assert told.err.count("\n") == 1
    assert "put together in 9 steps" in told.err
    html = page.read_text(encoding="utf-8")
    assert "--hold 1 --before voussoir-8 voussoir-0 -o" in html
    assert main(["plan", str(file), "--hold", "0", "-o", str(page), "--quiet"]) == 1
    assert "impossible" in page.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "begins"),
    [
        ("plan.glb", b"glTF"),
        ("plan.svg", b"<?xml"),
        ("plan.png", b"\x89PNG"),
        ("plan.pdf", b"%PDF"),
    ],
)
def test_films_and_figures_are_written_where_there_are_steps(name, begins, file, tmp_path, capsys):
    made = tmp_path / name
    assert main(["plan", str(file), "-o", str(made)]) == 0
    assert made.read_bytes().startswith(begins)
    made.unlink()
    capsys.readouterr()
    assert main(["plan", str(file), "--hold", "0", "-o", str(made)]) == 1
    told = capsys.readouterr()
    assert "with nothing held no order exists" in told.out
    assert "not written, because the plan has no steps" in told.err
    assert not made.exists()


@pytest.mark.slow
@pytest.mark.parametrize("page", [[], ["-o", "plan.html"]])
def test_an_earlier_proof_stays_where_there_is_none_and_that_is_said(
    page, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.json")
    Path("p.json").write_text("earlier")
    Path("order.txt").write_text("\n".join(f"cube-{k}" for k in (5, 4, 3, 2, 1)))
    words = ["plan", "tower.json", "--sequence", "order.txt", "--proof", "p.json", *page]
    assert main(words) == 1
    assert "p.json was not changed" in capsys.readouterr().err
    assert Path("p.json").read_text() == "earlier"


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", ["check", "plan", "hold", "region", "margin"])
def test_a_proof_is_never_written_over_the_file(command, tmp_path, capsys):
    path = tmp_path / "tower.json"
    kilter.dump(scene("tower"), path)
    before = path.read_text()
    assert main([command, str(path), "--proof", str(path)]) == 2
    assert "would be overwritten" in capsys.readouterr().err
    assert path.read_text() == before
