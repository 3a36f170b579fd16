"""The site is built without a warning, and asks for nothing from elsewhere."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("mkdocs")
pytest.importorskip("material")
pytest.importorskip("mkdocstrings")

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.slow
def test_the_site_is_built_strictly_and_works_offline(tmp_path):
    site = tmp_path / "site"
    result = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", str(site)],
        cwd=ROOT,
        env={"KILTER_GALLERY": "2", "NO_MKDOCS_2_WARNING": "1", **os.environ},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert result.returncode == 0, result.stderr
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 20
    for page in pages:
        text = page.read_text(encoding="utf-8")
        asked = re.findall(
            r"<(?:script|img|iframe|source)[^>]*\ssrc=[\"']?(https?:[^\"' >]+)", text
        )
        asked += re.findall(r"<link[^>]*rel=[\"']?(?:stylesheet|preconnect|icon)[^>]*>", text)
        assert not [a for a in asked if "http" in a], page.name
    live = sorted((site / "live").glob("*.html"))
    assert len(live) == 6
    for page in live:
        assert f"live/{page.name}" in (site / "gallery.html").read_text(encoding="utf-8")
        assert "<canvas" in page.read_text(encoding="utf-8")
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for target in re.findall(r'href="?((?:\.\./)*examples/[^">]+)', text):
            assert (page.parent / target).is_file(), f"{page.name}: {target}"
    assert (site / "examples/clamp.step").read_bytes() == (
        ROOT / "examples/clamp.step"
    ).read_bytes()
    shown = (site / "gallery.html").read_text(encoding="utf-8")
    assert "gallery/paper-figure-1.png" in shown
    assert (site / "gallery" / "paper-figure-1.png").stat().st_size > 10_000
    reference = (site / "reference" / "python" / "check.html").read_text(encoding="utf-8")
    assert "kilter.analysis.verdict.verdict.Verdict" in reference
