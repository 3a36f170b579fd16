"""Set the address of the repository, the only place where it is given.

python .ci/set_address.py https://github.com/OWNER/kilter https://OWNER.github.io/kilter

The first address is that of the repository, the second that of the site. The program writes both
into the metadata of the package, the site, the citation, the issue forms, README and notebooks.
It may run again with other addresses.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- address: begin -->", "<!-- address: end -->"


def replaced(path: Path, begin: str, end: str, lines: list[str], after: str) -> None:
    """Replace the lines between two marks; without the marks, add them after a line."""
    text = path.read_text(encoding="utf-8")
    block = "\n".join([begin, *lines, end]) + "\n"
    marked = re.compile(rf"(?ms)^{re.escape(begin)}$.*?^{re.escape(end)}$\n")
    if marked.search(text):
        text = marked.sub(lambda _: block, text, count=1)
    elif f"{after}\n" in text:
        text = text.replace(f"{after}\n", f"{after}\n{block}", 1)
    else:
        sys.exit(f"{path.name} has no line {after!r}")
    path.write_text(text, encoding="utf-8")


def badges(notebook: str, repository: str) -> str:
    """Links that open a notebook elsewhere."""
    place = repository.removeprefix("https://github.com/")
    colab = f"https://colab.research.google.com/github/{place}/blob/main/{notebook}"
    binder = f"https://mybinder.org/v2/gh/{place}/main?labpath={notebook.replace('/', '%2F')}"
    return f"[Open in Colab]({colab}) · [Open in Binder]({binder})"


def set_address(repository: str, site: str, root: Path = ROOT) -> None:
    """Write the addresses of repository and site into each file that needs them."""
    for address in (repository, site):
        if not re.fullmatch(r"https://[\w.-]+(/[\w.-]+)+", address):
            sys.exit(f"{address} is no address: give https://HOST/OWNER/NAME, without a last slash")
    marks = ("# address: begin", "# address: end")
    urls = {
        "Homepage": site,
        "Documentation": site,
        "Repository": repository,
        "Issues": f"{repository}/issues",
        "Changelog": f"{repository}/blob/main/CHANGELOG.md",
    }
    lines = ["[project.urls]", *(f'{name} = "{url}"' for name, url in urls.items())]
    replaced(root / "pyproject.toml", *marks, lines, "# the address of the project")
    lines = [f"site_url: {site}", f"repo_url: {repository}"]
    replaced(root / "mkdocs.yml", *marks, lines, "site_name: kilter")
    lines = [f"repository-code: {repository}", f"url: {site}"]
    replaced(root / "CITATION.cff", *marks, lines, "type: software")
    lines = [f"  homepage: {site}", f"  repository: {repository}"]
    replaced(root / "conda/recipe.yaml", *marks, lines, "about:")
    lines = [
        "contact_links:",
        "  - name: A question",
        f"    url: {repository}/discussions",
        "    about: Ask here how to do something with kilter.",
    ]
    config = root / ".github/ISSUE_TEMPLATE/config.yml"
    replaced(config, *marks, lines, "blank_issues_enabled: true")
    lines = [
        "",
        f"[![tests]({repository}/actions/workflows/tests.yml/badge.svg)]({repository}/actions)",
        f"[Site]({site}) · [Questions]({repository}/discussions)",
    ]
    replaced(root / "README.md", BEGIN, END, lines, "# kilter")
    for path in sorted((root / "examples").glob("*.ipynb")):
        content = json.loads(path.read_text(encoding="utf-8"))
        first = content["cells"][0]["source"]
        source = first if isinstance(first, str) else "".join(first)
        source = re.sub(r"\n\n\[Open in Colab\].*$", "", source, flags=re.S)
        source += f"\n\n{badges(f'examples/{path.name}', repository)}"
        content["cells"][0]["source"] = source.splitlines(keepends=True)
        text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("give two addresses: that of the repository and that of the site")
    set_address(*sys.argv[1:])
