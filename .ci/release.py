"""Set the version of the next release in each file that states it, and date the changelog.

python .ci/release.py 0.2.0

`kilter.__version__` is the version; CITATION.cff and the recipe follow it. Before that, pip-audit
looks for known vulnerabilities of the dependencies and of each extra for users: any of them ends
the release. The last lines printed are the commands that publish: the tag starts the workflow
`release`.
"""

from __future__ import annotations

import datetime
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATTERNS = {
    "src/kilter/__init__.py": r'(?m)^__version__ = "(.+)"$',
    "CITATION.cff": r"(?m)^version: (.+)$",
    "conda/recipe.yaml": r"(?m)^  version: (.+)$",
    "docs/index.md": r"(?m)^  version = \{(.+?)\},$",
}
DEVELOPERS = {"docs", "test", "browser", "notebook", "peers", "dev"}
"""Extras that no user installs."""
UNRELEASED = re.compile(r"(?m)^## \[Unreleased\].*$")


def versions(root: Path = ROOT) -> dict[str, str]:
    """The version that each file states."""
    found = {}
    for name, pattern in PATTERNS.items():
        match = re.search(pattern, (root / name).read_text(encoding="utf-8"))
        if not match:
            sys.exit(f"{name} states no version")
        found[name] = match[1]
    return found


def set_version(version: str, day: datetime.date, root: Path = ROOT) -> None:
    """Write the version and the day of a release."""
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        sys.exit(f"{version} is no version: give three numbers, such as 0.2.0")
    for name, pattern in PATTERNS.items():
        path = root / name
        text = path.read_text(encoding="utf-8")
        start, end = re.search(pattern, text).span(1)  # type: ignore[union-attr]
        path.write_text(text[:start] + version + text[end:], encoding="utf-8")
    citation = root / "CITATION.cff"
    text = re.sub(r"(?m)^date-released: .+\n", "", citation.read_text(encoding="utf-8"))
    line = f"version: {version}\n"
    citation.write_text(text.replace(line, f"{line}date-released: {day}\n"), encoding="utf-8")
    changes = root / "CHANGELOG.md"
    text = changes.read_text(encoding="utf-8")
    if not UNRELEASED.search(text):
        sys.exit("CHANGELOG.md has no section [Unreleased]")
    heading = f"## [Unreleased]\n\n## [{version}] - {day}"
    changes.write_text(UNRELEASED.sub(heading, text, count=1), encoding="utf-8")


def requirements(root: Path = ROOT) -> dict[str, list[str]]:
    """Requirements of kilter alone and with each extra for users."""
    with open(root / "pyproject.toml", "rb") as stream:
        project = tomllib.load(stream)["project"]
    extras = {"kilter": [], **project["optional-dependencies"]}
    return {
        name: project["dependencies"] + further
        for name, further in extras.items()
        if name not in DEVELOPERS
    }


def audit(name: str, lines: list[str]) -> tuple[str, bool]:
    """The sentence on the known vulnerabilities of requirements, and whether there are any.

    pip-audit exits with 1 for a vulnerability and for a service that it cannot reach, and with 0
    if the service knows none of the packages. Only its list of packages tells these apart.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "requirements.txt"
        path.write_text("\n".join(lines), encoding="utf-8")
        command = [sys.executable, "-m", "pip_audit", "--format", "json", "-r", str(path)]
        done = subprocess.run(
            [*command, "--progress-spinner", "off"], capture_output=True, text=True
        )
    try:
        packages = json.loads(done.stdout)["dependencies"]
    except (ValueError, KeyError, TypeError):
        reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
        return f"{name}: not audited, pip-audit failed: {reason}", False
    known = [package for package in packages if "skip_reason" not in package]
    found = [
        f"{package['name']} {package['version']}: {', '.join(entry['id'] for entry in entries)}"
        for package in known
        if (entries := package["vulns"])
    ]
    if found:
        return f"{name}: known vulnerabilities: {'; '.join(found)}", True
    if not known:
        return f"{name}: not audited, the service of pip-audit knows none of the packages", False
    count = f"{len(known)} of {len(packages)} packages audited"
    return f"{name}: no known vulnerability, {count}", False


def audit_all() -> None:
    """Print the sentence of kilter and of each extra; end if a vulnerability is known."""
    vulnerable = False
    for name, lines in requirements().items():
        sentence, bad = audit(name, lines)
        vulnerable |= bad
        print(sentence)
    if vulnerable:
        sys.exit("raise the lower bounds in pyproject.toml first; no file was changed")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("give the version: python .ci/release.py 0.2.0")
    audit_all()
    set_version(sys.argv[1], datetime.datetime.now(datetime.UTC).date())
    print("python .ci/package.py --pythons")
    print(f"git commit -am 'Release {sys.argv[1]}' && git tag v{sys.argv[1]}")
    print("git push && git push --tags")
