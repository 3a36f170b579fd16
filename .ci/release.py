"""Set the version of the next release in each file that states it, and date the changelog.

python .ci/release.py 0.2.0

`kilter.__version__` is the version; CITATION.cff and the recipe follow it. The last lines printed
are the commands that publish: the tag starts the workflow `release`.
"""

from __future__ import annotations

import datetime
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATTERNS = {
    "src/kilter/__init__.py": r'(?m)^__version__ = "(.+)"$',
    "CITATION.cff": r"(?m)^version: (.+)$",
    "conda/recipe.yaml": r"(?m)^  version: (.+)$",
    "docs/index.md": r"(?m)^  version = \{(.+?)\},$",
}
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


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("give the version: python .ci/release.py 0.2.0")
    set_version(sys.argv[1], datetime.datetime.now(datetime.UTC).date())
    print("python .ci/package.py --pythons")
    print(f"git commit -am 'Release {sys.argv[1]}' && git tag v{sys.argv[1]}")
    print("git push && git push --tags")
