"""Forms of a command line, and its values; wrong forms are a sentence with the remedy."""

from pathlib import Path
from typing import Any

import pytest

from kilter import InputError
from kilter.cli import main
from kilter.cli.commands import functions_of
from kilter.cli.option_parser import values_of


def values(line: str) -> dict[str, Any]:
    """The values of a command line that differ from the defaults."""
    name, *words = line.split(" ")
    [function] = functions_of(name)
    plain = values_of(function, ["a.json", "b.json"][: 2 if name == "verify" else 1])
    given = values_of(function, words)
    return {key: value for key, value in given.items() if value != plain[key]}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("check a.json", {}),
        ("check --floor b.json", {"floor": "lowest", "files": ["b.json"]}),
        ("check --floor .2 a.json", {"floor": 0.2}),
        ("check --floor -2e-1 a.json", {"floor": -0.2}),
        ("check --floor=1 a.json", {"floor": 1.0}),
        ("check --ground a b a.json", {"ground": ("a", "b")}),
        ("check --ground a.json a.json", {"ground": ("a.json",)}),
        ("check a.json --ground a b --ground c", {"ground": ("a", "b", "c")}),
        ("check --accelerate -.5g 0 0 a.json", {"accelerate": ("-.5g", "0", "0")}),
        ("check --down 1e-3 0 -1e-3 a.json", {"down": (0.001, 0.0, -0.001)}),
        ("check --up -z a.json", {"up": "-z"}),
        ("check -", {"files": ["-"]}),
        ("check --no-floor --no-fasten-suggested a.json", {"off": ("floor", "fasten_suggested")}),
        ("check --off floor loose --release a b a.json",
         {"off": ("floor", "loose"), "release": ("a", "b")}),
        ("check x.json --json y.json", {"files": ["x.json", "y.json"], "json": True}),
        ("check -vo x a.json", {"verbose": True, "output": Path("x")}),
        ("check -o - a.json", {"output": Path("-")}),
        ("check --friction 30% --density steel a.json", {"friction": 0.3, "density": 7850}),
        ("check --friction=45deg a.json", {"friction": pytest.approx(1.0)}),
        ("check --units m --units mm a.json", {"units": "mm"}),
        ("check --fasten bolt* nut* --bond a b 1e2 a.json",
         {"fasten": (("bolt*", "nut*"),), "bond": (("a", "b", 100.0),)}),
        ("check --mass a=1 --mass b=2 a.json", {"mass": (("a", 1.0), ("b", 2.0))}),
        ("check -- -x.json", {"files": ["./-x.json"]}),
        ("plan --before a b --turn --hold 2 a.json",
         {"before": [("a", "b")], "turn": True, "hold": 2}),
        ("orient --method walk a.json", {"method": "walk"}),
        ("batch a.json -o rows --chunk 7", {"output": Path("rows"), "chunk": 7}),
        ("verify a.json b.json --require proved", {"require": "proved"}),
        ("view --port 80 b.json", {"port": 80, "file": "b.json"}),
    ],
)  # fmt: skip
def test_values_of_a_line(line: str, expected: dict[str, Any]) -> None:
    if line.startswith("batch"):
        [function] = functions_of("batch")
        given = values_of(function, line.split()[1:])
        assert {name: given[name] for name in expected} == expected
        return
    assert values(line) == expected


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("check", "FILE is missing"),
        ("check a.json --fric 1", "there is no option --fric: did you mean --friction?"),
        ("check a.json --mu 1", "there is no option --mu: use --friction"),
        ("check a.json --friction", "--friction needs MU"),
        ("check a.json --friction --json", "--friction needs MU"),
        ("check a.json --friction x", "--friction has 'x'"),
        ("check a.json --gap x", "--gap has 'x', not a number"),
        ("check a.json --quiet=1", "--quiet takes no value, but has '1'"),
        ("check a.json --down 0 1", "--down needs X Y Z"),
        ("check a.json --down 0 0 x", "--down has 'x', not a number"),
        ("check a.json --fasten a", "--fasten needs NAME NAME"),
        ("verify a.json", "P.json is missing"),
        ("doctor a.json", "there is a word too many: 'a.json'"),
        ("plan a.json --hold 1.5", "--hold has '1.5', not a whole number"),
        ("orient a.json --method x", "--method has 'x', not one of joint|walk"),
        ("batch a.json", "-o/--output is missing"),
        ("chek a.json", "there is no command 'chek'; did you mean 'check'?"),
        ("--jsn", "there is no option '--jsn'; see 'kilter --help'"),
        ("a.json", "there is no command 'a.json'; type 'kilter check a.json'"),
        ("help plan", "there is no command 'help'; type 'kilter plan --help'"),
        ("--down plan a.json", "options follow the command: kilter plan FILE --down"),
    ],
)
def test_a_wrong_line_is_a_sentence(
    line: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(line.split()) == 2
    message = capsys.readouterr().err
    assert message.startswith("kilter: ")
    assert message.count("\n") == 1
    assert words in message


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_completes_commands_and_options(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("shtab")
    assert main(["--print-completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(word in script for word in ("check-plan", "--fasten-suggested", "--forward"))


def test_an_unknown_shell_is_a_sentence() -> None:
    pytest.importorskip("shtab")
    from kilter.cli.option_parser import completion

    with pytest.raises(InputError, match="no completion for 'dos'; give one of bash"):
        completion("dos")
