"""Build the distributions, and check their files, metadata and installation.

python .ci/package.py             build into a temporary folder, and check files and metadata
python .ci/package.py --pythons   also install the wheel on each Python from 3.11 to 3.14 here
python .ci/package.py --extras    also resolve each extra, without installing it
python .ci/package.py --notebooks run each notebook in a new environment, from the wheel
python .ci/package.py -o dist     keep the distributions

The checks need the tools of .ci/package-requirements.txt.
"""

from __future__ import annotations

import argparse
import email
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WHEEL_LIMIT = 3_000_000
"""Largest wheel [bytes]."""
FILE_LIMIT = 1_000_000
"""Largest file of the source distribution [bytes]."""
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
EXAMPLE = "examples/paper-figure-9.kilter.json"


def run(*words: object, where: Path = ROOT) -> str:
    """Run a command; end with its output if it fails."""
    done = subprocess.run([str(w) for w in words], cwd=where, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done.stdout


def tool(name: str) -> Path:
    """Path of a command of this environment."""
    return Path(sys.executable).with_name(name)


def require(true: bool, sentence: str) -> None:
    """End with a sentence unless a condition holds."""
    if not true:
        sys.exit(sentence)


def check_files(wheel: Path, source: Path) -> None:
    """Sizes, and the files that must and must not be there."""
    require(wheel.stat().st_size < WHEEL_LIMIT, f"{wheel.name} has {wheel.stat().st_size} bytes")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    needed = {"kilter/py.typed", "kilter/show/assets/page.js"}
    needed |= {
        path.relative_to(ROOT / "src").as_posix()
        for path in (ROOT / "src/kilter").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    require(needed <= names, f"the wheel lacks {sorted(needed - names)[:5]}")
    others = [name for name in names if not name.startswith(("kilter/", "kilter-"))]
    require(not others, f"the wheel has other files: {others[:5]}")
    with tarfile.open(source) as archive:
        members = [one for one in archive.getmembers() if one.isfile()]
    large = [one.name for one in members if one.size > FILE_LIMIT]
    require(not large, f"files over {FILE_LIMIT} bytes in the source distribution: {large}")
    inside = {one.name.partition("/")[2] for one in members}
    for name in ("README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff", "tests/conftest.py"):
        require(name in inside, f"the source distribution lacks {name}")
    hidden = [name for name in inside if name.startswith(".") and name != ".gitignore"]
    require(not hidden, f"hidden files in the source distribution: {hidden}")
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB, {len(names)} files")
    largest = max(members, key=lambda one: one.size)
    print(
        f"{source.name}: {source.stat().st_size / 1e6:.2f} MB, {len(inside)} files, the largest "
        f"{largest.name.partition('/')[2]} with {largest.size / 1e6:.2f} MB"
    )


def check_version(wheel: Path) -> str:
    """Version of the wheel, which CITATION.cff and the recipe also state."""
    with zipfile.ZipFile(wheel) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        version = str(email.message_from_bytes(archive.read(name))["Version"])
    for path, line in (
        ("CITATION.cff", f"version: {version}"),
        ("conda/recipe.yaml", f"  version: {version}"),
    ):
        text = (ROOT / path).read_text(encoding="utf-8").splitlines()
        require(line in text, f"{path} does not state {line.strip()!r}")
    return version


def check_metadata(wheel: Path, source: Path) -> None:
    """Metadata, rendered README, and the files that other services read."""
    print(run(tool("twine"), "check", "--strict", wheel, source).strip())
    print(run(tool("check-wheel-contents"), wheel).strip())
    print(run(tool("validate-pyproject"), "pyproject.toml").strip())
    print(run(tool("cffconvert"), "--validate", "-i", "CITATION.cff").strip())
    workflows = sorted((ROOT / ".github/workflows").glob("*.yml"))
    schema = "vendor.github-workflows"
    print(run(tool("check-jsonschema"), "--builtin-schema", schema, *workflows).strip())


def check_paper(folder: Path) -> None:
    """Compile the paper of the software."""
    import pypandoc

    out, options = folder / "paper.html", ["--citeproc", f"--bibliography={ROOT}/paper/paper.bib"]
    pypandoc.convert_file(
        str(ROOT / "paper/paper.md"), "html", extra_args=[*options, "--standalone"], outputfile=out
    )
    require("???" not in out.read_text(encoding="utf-8"), "the paper cites what is not listed")
    print("paper/paper.md: compiles")


def install(wheel: Path, version: str, python: str, folder: Path) -> None:
    """Install the wheel on a Python of a version, and check an example."""
    found = shutil.which(f"python{python}")
    right = f"import sys; sys.exit(sys.version_info[:2] != {tuple(map(int, python.split('.')))})"
    if not found or subprocess.run([found, "-c", right], capture_output=True).returncode:
        print(f"Python {python} is not here: not tried")
        return
    place = folder / python
    run(found, "-m", "venv", place)
    commands = place / ("Scripts" if sys.platform == "win32" else "bin")
    run(commands / "python", "-m", "pip", "install", "--quiet", wheel)
    told = run(commands / "kilter", "--version", where=folder).strip()
    require(told == f"kilter {version}", f"Python {python}: {told}")
    answer = run(commands / "kilter", "check", ROOT / EXAMPLE, where=folder)
    print(f"Python {python}: {answer.splitlines()[0]}")


def resolve(wheel: Path) -> None:
    """Resolve the requirements of each extra, without installing them."""
    with open(ROOT / "pyproject.toml", "rb") as stream:
        extras = tomllib.load(stream)["project"]["optional-dependencies"]
    for name in extras:
        run(sys.executable, "-m", "pip", "install", "--dry-run", "--quiet", f"{wheel}[{name}]")
        print(f"extra {name}: resolves")


def run_notebooks(wheel: Path, folder: Path) -> None:
    """Run each notebook in an environment with the wheel and the extras that the notebook names."""
    sys.path.insert(0, str(ROOT / "docs"))
    from run_notebooks import extras

    for path in sorted((ROOT / "examples").glob("*.ipynb")):
        place = folder / path.stem
        run(sys.executable, "-m", "venv", place)
        commands = place / ("Scripts" if sys.platform == "win32" else "bin")
        package = f"{wheel}[{extras(path)},notebook]"
        run(commands / "python", "-m", "pip", "install", "--quiet", package)
        run(commands / "python", ROOT / "docs/run_notebooks.py", "--compare", path.stem)
        print(f"{path.name}: runs with {extras(path)}, and prints the kept text")
        shutil.rmtree(place)


def main() -> None:
    """Build and check."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--pythons", action="store_true")
    parser.add_argument("--extras", action="store_true")
    parser.add_argument("--notebooks", action="store_true")
    parser.add_argument("-o", dest="out", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        run(sys.executable, "-m", "build", "--outdir", folder, ROOT)
        (wheel,), (source,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
        check_files(wheel, source)
        version = check_version(wheel)
        check_metadata(wheel, source)
        check_paper(folder)
        if given.pythons:
            for python in PYTHONS:
                install(wheel, version, python, folder)
        if given.extras:
            resolve(wheel)
        if given.notebooks:
            run_notebooks(wheel, folder)
        if given.out:
            given.out.mkdir(parents=True, exist_ok=True)
            for path in (wheel, source):
                shutil.copy(path, given.out)


if __name__ == "__main__":
    main()
