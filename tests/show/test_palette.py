"""The palette: distinguishable with colour blindness, readable in light and dark, unique."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from kilter.tell.palette import GROUND, PALETTE, RAMP, ROLES, as_css, rgb

ROOT = Path(__file__).resolve().parents[2]
THEMES = ("light", "dark")
SEEN = {
    "all": np.eye(3),
    "no red": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
         [-0.003882, -0.048116, 1.051998]]
    ),
    "no green": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
         [-0.011820, 0.042940, 0.968881]]
    ),
    "no blue": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
         [0.004733, 0.691367, 0.303900]]
    ),
}  # fmt: skip
"""Linear sRGB as seen with a missing kind of cone: Machado, Oliveira, Fernandes, 2009."""
APART = 10.0
"""Least distance of two signs in CIELAB; a distance of 2.3 is just noticeable."""


def linear(colour: str) -> np.ndarray:
    share = np.array(rgb(colour)) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lightness(colour: str) -> float:
    return float(np.array([0.2126, 0.7152, 0.0722]) @ linear(colour))


def contrast(one: str, other: str) -> float:
    low, high = sorted([lightness(one), lightness(other)])
    return (high + 0.05) / (low + 0.05)


def lab(seen: np.ndarray) -> np.ndarray:
    """CIELAB of linear sRGB, white D65."""
    xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    ) @ np.clip(seen, 0, 1) / [0.9505, 1, 1.089]  # fmt: skip
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_distances_and_contrasts_are_those_of_the_books() -> None:
    assert np.allclose(lab(linear("#ffffff")), [100, 0, 0], atol=0.02)
    assert np.allclose(lab(linear("#ff0000")), [53.24, 80.09, 67.2], atol=0.05)
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)
    # this slate and purple look equal without the cone for green
    slate, purple = (linear(c) for c in ("#5b6673", "#a3307f"))
    assert np.linalg.norm(lab(slate) - lab(purple)) > 4 * APART
    assert np.linalg.norm(lab(SEEN["no green"] @ slate) - lab(SEEN["no green"] @ purple)) < APART


@pytest.mark.parametrize("eye", SEEN)
@pytest.mark.parametrize("theme", THEMES)
def test_signs_are_told_apart(theme: str, eye: str) -> None:
    signs = {name: getattr(one, theme) for name, one in ROLES.items() if one.use == "sign"}
    places = {k: lab(SEEN[eye] @ linear(c)) for k, c in {**signs, "held": GROUND}.items()}
    for a, b in itertools.combinations(places, 2):
        assert np.linalg.norm(places[a] - places[b]) > APART, (a, b)


@pytest.mark.parametrize("theme", THEMES)
def test_words_and_signs_stand_out_from_what_is_behind_them(theme: str) -> None:
    of = {name: getattr(one, theme) for name, one in ROLES.items()}
    for name in ("stable", "unstable", "undecided", "ink", "soft", "link", "grip"):
        assert contrast(of[name], of["surface"]) >= 4.5, name
    signs = {name for name, one in ROLES.items() if one.use == "sign"}
    for name in signs - {"open"}:  # a ball with a rim of ink
        for ground in ("surface", "stage-top", "stage-bottom"):
            assert contrast(of[name], of[ground]) >= 3.0, (name, ground)


def test_the_ramp_gets_darker_for_every_eye() -> None:
    for eye in SEEN.values():
        levels = [lab(eye @ linear(colour))[0] for colour in RAMP]
        assert (np.diff(levels) < -APART / 2).all()


def test_signs_are_stronger_than_the_parts_they_lie_on() -> None:
    parts = [*PALETTE, GROUND]
    for name in ("unstable", "force", "limit", "patch"):
        assert min(contrast(ROLES[name].light, part) for part in parts) > 1.7, name


def test_the_style_has_every_role_in_light_and_dark() -> None:
    light, *dark = as_css().strip().split("\n")
    assert len(dark) == 2
    for name, one in ROLES.items():
        assert f"--{name}: {one.light};" in light
        assert all(f"--{name}: {one.dark};" in line for line in dark)


LITERAL = re.compile(
    r"#[0-9a-fA-F]{6}\b|#[0-9a-fA-F]{3}\b(?=[;'\"\s])|\brgba?\(\s*\d|\bhsla?\(\s*\d"
    r"|[\"'](?:white|black|red|green|blue|orange|yellow|purple|gr[ae]y)[\"']"
)


@pytest.mark.slow
def test_no_other_colour_is_in_the_sources() -> None:
    found = []
    folders = {"src/kilter": "py css html js", "web/src": "js", "docs": "py css js"}
    for folder, kinds in folders.items():
        for kind in kinds.split():
            for path in sorted((ROOT / folder).rglob(f"*.{kind}")):
                if path.name in ("palette.py", "page.js"):
                    continue
                for line in path.read_text(encoding="utf-8").splitlines():
                    if LITERAL.search(line.replace("#rrggbb", "")):
                        found.append(f"{path.relative_to(ROOT)}: {line.strip()[:80]}")
    assert not found
    for sign in ('"#1b2530"', "color: #fff;", "rgb(1,2,3)", 'color="white"'):
        assert LITERAL.search(sign)


def test_the_page_of_the_docs_has_the_table() -> None:
    text = (ROOT / "docs" / "colours.md").read_text(encoding="utf-8")
    rows = [f"| {name} | {one.says} | {one.light} | {one.dark} |" for name, one in ROLES.items()]
    assert "\n".join(rows) in text
    for colour in (GROUND, *PALETTE, *RAMP):
        assert colour in text
