"""README's thumbnails: each has its command, and the command draws the picture."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from draw_gallery import ENTRIES, FOLDER, draw, table, with_table  # noqa: E402

from kilter.scenes import SCENES  # noqa: E402


def test_readme_has_the_table_of_twelve_thumbnails():
    assert len(ENTRIES) == 12
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert with_table(readme) == readme
    with pytest.raises(ValueError, match="0 blocks between"):
        with_table("# kilter")
    assert table().count("<code>kilter ") == 12


def test_each_thumbnail_is_a_small_picture_of_a_built_in_example():
    assert {path.stem for path in FOLDER.glob("*.webp")} == {entry.scene for entry in ENTRIES}
    for entry in ENTRIES:
        assert entry.scene in SCENES
        assert (FOLDER / f"{entry.scene}.webp").stat().st_size < 20_000


@pytest.mark.slow
@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.scene)
def test_the_command_of_a_thumbnail_draws_a_picture(entry, tmp_path):
    assert draw(entry, tmp_path).read_bytes().startswith(b"\x89PNG")
