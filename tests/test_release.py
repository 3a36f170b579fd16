"""The version and the address have a single place each, and reach every file that states them."""

from __future__ import annotations

import datetime
import importlib.util
import json
import shutil
import subprocess
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

import kilter

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = ROOT / ".ci"
pytestmark = pytest.mark.skipif(
    not (PROGRAMS / "release.py").is_file(), reason="a source distribution has no folder .ci"
)
FILES = (
    "src/kilter/__init__.py", "CITATION.cff", "conda/recipe.yaml", "docs/index.md",
    "CHANGELOG.md", "pyproject.toml", "mkdocs.yml", "README.md",
    ".github/ISSUE_TEMPLATE/config.yml",
)  # fmt: skip
WORKFLOWS = (".github/workflows/tests.yml", ".github/workflows/release.yml")
REPOSITORY, SITE = "https://github.com/owner/kilter", "https://owner.github.io/kilter"


def program(name: str) -> ModuleType:
    """A program of the folder .ci as a module."""
    spec = importlib.util.spec_from_file_location(name, PROGRAMS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The files that a release or an address changes, and the notebooks."""
    notebooks = [path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").glob("*.ipynb")]
    for name in (*FILES, *notebooks):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    return tmp_path


def test_each_file_states_the_version_of_the_package() -> None:
    assert set(program("release").versions().values()) == {kilter.__version__}


def test_a_release_sets_the_version_and_dates_the_changelog(copy: Path) -> None:
    release = program("release")
    for version in ("0.2.0", "0.3.0"):
        release.set_version(version, datetime.date(2027, 1, 31), copy)
        assert set(release.versions(copy).values()) == {version}
    changes = (copy / "CHANGELOG.md").read_text(encoding="utf-8")
    assert changes.index("## [Unreleased]") < changes.index("## [0.3.0] - 2027-01-31")
    assert changes.index("## [0.3.0]") < changes.index("## [0.2.0]")
    citation = (copy / "CITATION.cff").read_text(encoding="utf-8")
    assert citation.count("date-released: 2027-01-31") == 1
    with pytest.raises(SystemExit, match="is no version: give three numbers"):
        release.set_version("0.3", datetime.date(2027, 1, 31), copy)


AUDITS = {
    "bad": ({"vulns": [{"id": "PYSEC-1"}, {"id": "PYSEC-2"}]}, "solver 1.0: PYSEC-1, PYSEC-2"),
    "good": ({"vulns": []}, "no known vulnerability, 1 of 2 packages audited"),
    "unknown": ({"skip_reason": "not found"}, "the service of pip-audit knows none"),
    "unreachable": (None, "not audited, pip-audit failed: no route to the service"),
}


@pytest.mark.parametrize("case", AUDITS)
def test_only_a_known_vulnerability_ends_a_release(
    case: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A service that is out of reach, or knows no package, is named: it proves nothing."""
    answer, sentence = AUDITS[case]
    other = {"name": "own", "skip_reason": "not found"}
    packages = [{"name": "solver", "version": "1.0", **(answer or {})}, other]
    output = json.dumps({"dependencies": packages}) if answer else ""
    done = subprocess.CompletedProcess([], 1, output, "Traceback\nno route to the service\n")
    release = program("release")
    monkeypatch.setattr(release.subprocess, "run", lambda *_, **__: done)
    if case == "bad":
        with pytest.raises(SystemExit, match="no file was changed"):
            release.audit_all()
    else:
        release.audit_all()
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(release.requirements())
    assert all(sentence in line for line in lines)


def test_an_audit_names_the_requirements_of_users() -> None:
    release = program("release")
    required = release.requirements()
    assert {"kilter", "step", "mcp"} <= set(required)
    assert not set(required) & release.DEVELOPERS
    assert all(set(required["kilter"]) <= set(lines) for lines in required.values())
    assert any(line.startswith("mcp") for line in required["mcp"])


def test_every_place_states_the_same_pythons() -> None:
    """Classifiers, the checks of a release, the workflows and the recipe."""
    with open(ROOT / "pyproject.toml", "rb") as stream:
        project = tomllib.load(stream)["project"]
    heading = "Programming Language :: Python :: 3."
    stated = [int(c.removeprefix(heading)) for c in project["classifiers"] if c.startswith(heading)]
    first, last = stated[0], stated[-1]
    assert stated == list(range(first, last + 1))
    pythons = tuple(f"3.{minor}" for minor in stated)
    assert pythons == program("package").PYTHONS
    assert project["requires-python"] == f">=3.{first},<3.{last + 1}"
    texts = {
        name: (ROOT / name).read_text(encoding="utf-8")
        for name in (*FILES, "CONTRIBUTING.md", *WORKFLOWS)
    }
    for name in ("README.md", "docs/index.md", "CONTRIBUTING.md"):
        assert f"Python 3.{first} to 3.{last}" in texts[name], name
    assert f"python {project['requires-python']}" in texts["conda/recipe.yaml"]
    for name in WORKFLOWS:
        assert f"python: {json.dumps(pythons)}" in texts[name], name


def test_the_recipe_needs_what_the_package_needs() -> None:
    with open(ROOT / "pyproject.toml", "rb") as stream:
        needed = tomllib.load(stream)["project"]["dependencies"]
    recipe = (ROOT / "conda/recipe.yaml").read_text(encoding="utf-8")
    for line in needed:
        name, bound = line.replace("[extras]", "").split(">=")
        assert f"- {name} >={bound}\n" in recipe, line


def test_an_address_reaches_each_file_and_can_be_changed(copy: Path) -> None:
    address = program("set_address")
    untouched = {path: path.read_bytes() for path in copy.rglob("*") if path.is_file()}
    address.set_address("https://example.org/a/b", "https://example.org/c", copy)
    address.set_address(REPOSITORY, SITE, copy)
    for path, before in untouched.items():
        text = path.read_text(encoding="utf-8")
        assert "example.org" not in text
        unchanged = {"CHANGELOG.md", "__init__.py", "index.md"}
        assert (path.read_bytes() == before) == (path.name in unchanged), path.name
    with open(copy / "pyproject.toml", "rb") as stream:
        urls = tomllib.load(stream)["project"]["urls"]
    assert urls["Repository"] == REPOSITORY
    assert urls["Documentation"] == SITE
    for path in (copy / "examples").glob("*.ipynb"):
        first = json.loads(path.read_text(encoding="utf-8"))["cells"][0]
        assert "".join(first["source"]).count(f"/owner/kilter/blob/main/examples/{path.name}") == 1
    with pytest.raises(SystemExit, match="kilter is no address: give https://HOST/OWNER/NAME"):
        address.set_address("kilter", SITE, copy)
