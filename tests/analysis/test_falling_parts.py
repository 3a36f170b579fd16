"""Parts that fall freely: the part below them, the length of the fall, and the words."""

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.scenes.pieces import block
from kilter.tell.motion_rows import MOST_MOTIONS
from kilter.tell.tables import moving_table
from kilter.tell.text import text_of

TABLE = block("table", [-9, -9, -1], [99, 9, 0], grounded=True)


def cube(name: str, x: float, z: float, size: float = 1.0) -> Part:
    return Part(name, Box(size, size, size), Pose([x, 0, z + size / 2]))


def landing(verdict: kilter.Verdict, name: str) -> tuple[str | None, float | None]:
    return verdict[name].below, verdict[name].fall


def test_a_falling_part_names_the_part_below_and_the_length_of_the_fall():
    parts = [TABLE, cube("low", 0, 0), cube("high", 0.25, 1.5), cube("aside", 3, 0.125)]
    verdict = kilter.check(Assembly(parts, units="mm"))
    assert landing(verdict, "high") == ("low", pytest.approx(0.5))
    assert landing(verdict, "aside") == ("table", pytest.approx(0.125))
    assert landing(verdict, "low") == landing(verdict, "table") == (None, None)
    assert verdict.words("high") == "falls 0.5 mm onto low"
    assert verdict["aside"].to_dict()["motion"] == "falls 0.125 mm onto table"


def test_parts_that_touch_fall_together():
    """The upper of two cubes that fall together never meets the lower one."""
    verdict = kilter.check(Assembly([TABLE, cube("a", 0, 0.5), cube("b", 0, 1.5)]))
    assert landing(verdict, "a") == landing(verdict, "b") == ("table", pytest.approx(0.5))


def test_a_part_above_a_falling_part_is_not_said_to_land_on_it():
    verdict = kilter.check(Assembly([TABLE, cube("a", 0, 0.5), cube("b", 0, 2.0)]))
    assert landing(verdict, "b") == ("a", pytest.approx(0.5))
    assert verdict.words("b") == "falls freely 0.5 m above a"
    assert verdict.words("a") == "falls 0.5 m onto table"


def test_only_straight_free_falls_have_a_part_below():
    """A cube over an edge tips, a cube on a smooth slope slides; a cube over nothing just falls."""
    tips = kilter.check(Assembly([TABLE, block("tips", [98, 0, 0], [101, 1, 1])]))
    assert tips.verdict == "unstable"
    assert landing(tips, "tips") == (None, None)
    assert tips.words("tips").startswith("tips about ")
    over = kilter.check(Assembly([TABLE, cube("over", 200, 1)]))
    assert landing(over, "over") == (None, None)
    assert over.words("over") == "falls freely at 1 g"
    slides = kilter.check(Assembly([TABLE, cube("slides", 0, 0)]).with_down([0.1, 0, -1]))
    assert landing(slides, "slides") == (None, None)
    assert slides.words("slides").startswith("slides down +x at ")


def cabinet(count: int) -> kilter.Verdict:
    """Drawers 18 mm above shelves that are held, with a lid that tips off the last."""
    shelves = [block(f"shelf_{k}", [0, 0, 100 * k], [50, 50, 100 * k + 5], grounded=True)
               for k in range(count)]  # fmt: skip
    drawers = [block(f"drawer_{k}", [1, 1, 100 * k + 23], [40, 49, 100 * k + 60])
               for k in range(count)]  # fmt: skip
    top = 100 * count - 95
    lid = block("lid", [45, 0, top], [80, 50, top + 1])
    return kilter.check(Assembly([*shelves, *drawers, lid], units="mm"))


def test_equal_motions_share_a_row_and_verbose_text_lists_all():
    answer = cabinet(8).to_dict()
    text = text_of(answer, brief=True)
    assert "9 of 9 free parts move:\n" in text
    assert "  drawer_* (8 parts)  each falls 18 mm onto shelf_* (8 parts)\n" in text
    assert "  lid                 tips about +y" in text
    assert text.count("drawer_") == 1
    full = text_of(answer)
    assert [f"falls 18 mm onto shelf_{k}\n" in full for k in range(8)] == [True] * 8
    assert "  drawer_0  falls 18 mm onto shelf_0\n" in text_of(cabinet(2).to_dict(), brief=True)


@pytest.mark.parametrize("many", [MOST_MOTIONS, MOST_MOTIONS + 3])
def test_the_brief_text_has_at_most_twelve_rows(many):
    names = [chr(ord("a") + k) for k in range(many)]
    parts = [cube(name, 3 * k, 0.5 + k) for k, name in enumerate(names)]
    answer = kilter.check(Assembly([TABLE, *parts])).to_dict()
    table = moving_table(answer, brief=True)
    assert table is not None
    rows = table.rows(0)
    assert len(rows) == MOST_MOTIONS
    last = ("and 4 more (--verbose lists all)", "") if many > MOST_MOTIONS else (
        names[-1], f"falls {many - 0.5:g} m onto table")  # fmt: skip
    assert rows[-1] == last
    text = text_of(answer)
    assert all(f"  {name}  falls {k + 0.5:g} m onto table" in text for k, name in enumerate(names))


def test_many_parts_with_different_names_share_a_row_if_the_rows_are_too_many():
    names = [f"part {chr(ord('a') + k)}" for k in range(20)]
    parts = [cube(name, 3 * k, 0.5) for k, name in enumerate(names)]
    table = moving_table(kilter.check(Assembly([TABLE, *parts])).to_dict(), brief=True)
    assert table is not None
    [(parts_of_row, motion)] = table.rows(0)
    assert parts_of_row.startswith("part ")
    assert parts_of_row.endswith(" and 17 more")
    assert motion == "each falls 0.5 m onto table"


def test_the_warnings_about_parts_that_touch_nothing_are_grouped():
    warnings = cabinet(8).warnings
    grouped = "touches nothing: 'drawer_*' (7 parts, 18 mm from 'shelf_*'), 'drawer_7' (17.7 mm"
    assert [text for text in warnings if text.startswith(grouped)] == [f"{grouped} from 'lid')"]
