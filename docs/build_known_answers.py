"""The page of known answers of second order: ``python docs/build_known_answers.py``.

What is known comes from `kilter.scenes.balance`, what kilter finds from `kilter.check`, on both
sides of each limit, of what rolls from `find_rolling`; `SHOWS` says what a case is there for.
"""

from __future__ import annotations

from pathlib import Path

import kilter
from kilter.assembly import Assembly
from kilter.mechanics.program import build_program
from kilter.scenes.balance import CASES, GRIP, ROLLING, Case
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.motions.rolling import find_rolling
from kilter.tell.numbers import number

PAGE = Path(__file__).resolve().parent / "known-answers.md"
BESIDE = 0.1
"""How far from a limit both sides are asked [that of its parameter]."""
ROLLS = {"minimum": "holds", "balanced": "falls"}

HEAD = """# Known answers of second order

To first order each of these stands, those that roll by friction: forces of equilibrium exist, and
no motion gains energy at once. What second order adds is known for each, by its closed form or by
hand, and the tests ask kilter for it on both sides of every limit. This page is written by `python
docs/build_known_answers.py`, which asks for it anew; how it is proved is in the
[theory](theory.md), what the words mean in [what the answers mean](answers.md).

The cases are `kilter.scenes.balance`. Contacts are given with what touches and how it curves
([features](contacts.md#features)); the pictures are drawn from these, and choose what a case leaves
open, as how thick a plank is. Where there is a limit, the first state is below it and the second
above, as kilter finds them {beside} from it. *Costs nothing* counts the motions that cost nothing
to first order, *free* those of them that are proved to cost nothing at all, below the limit.
Lengths in m.

"""
SLIPPERY = """## Without friction

A *minimum* is strict but for free spins of round parts, *free* the same across motions that cost
nothing; *balanced* falls at the slightest push.

{signs}
{cards}
Of {all} states {found} are found; {open}.

| | case | known | kilter finds | costs nothing | free |
|---|---|---|---|---|---|
"""
SIGNS = """Held parts are striped. Quartered circles are centres of mass, below the limit, and the
dashed line is where they are at it. One orange arrow away: it falls so. Two blue arrows back:
pushed so, it returns. Two plain arrows away: it goes so at no cost.
"""
CARD = """
-   ![{number}: {title}](images/known/{number}.svg){{ loading=lazy }}

    **{number}. {heading}:** {known}. {shows}.
"""
GRIPPING = """
## Rolling without slip

With friction nothing here slips. It *holds* what rolls back, and what rolls off *falls*. What
touches at one point of a plane is asked in that plane too, where rolling has one dimension. In
space what rolls in a circle may come back shifted: where no energy bounds the sum of such shifts,
the answer is *open* ([theory](theory.md)). A minimum without friction, or what is free there,
holds with any.

{cards}
| | case | known | in the plane | in space |
|---|---|---|---|---|
"""

SHOWS = {
    "01": "two shifts and three turns",
    "02": "the plainest balance",
    "03": "rolls back; its spins are free",
    "04": "one way down is enough",
    "05": "slides along, and spins",
    "06": "held along the line of the two, falls across it",
    "07": "no motion but spins is left",
    "08": "stands on its shortest axis, and on no other",
    "09": "the centre of mass against that of the sphere",
    "10": "the same on an edge that is round",
    "11": "slides off, however low its centre",
    "12": "slides off either",
    "13": "a line of contact at five points: forces are not unique",
    "14": "a line of contact that comes back",
    "15": "the pair turns about the tube",
    "16": "walls leave nothing but spins",
    "17": "no motion opens both plates: the path keeps them",
    "18": "nothing at its side",
    "19": "ends that slide down as it turns",
    "20": "the limit is minus the tangent of the slope",
    "21": "hangs, and slips round",
    "22": "the same where it is not round about its centre of mass",
    "23": "as a coin on its rim",
    "24": "slides out as it tips",
    "24b": "the same where it cannot slide",
    "25": "a pendulum, and one on its head",
    "26": "spins about its axis, and turns about the upright one",
    "27": "an axis that is not through the centre of mass",
    "28": "many contacts, no motion but spins",
    "29": "falls across, rolls along",
    "30": "comes back across, rolls along",
    "31": "held by the ring, off it at its side",
    "32": "falls flat",
    "33": "level shifts and a turn",
    "34": "free motions of four parts at once",
    "35": "three level motions of each box",
    "36": "tips about the line of the two",
    "37": "a weeble across the row, feet along it",
    "38": "no motion is free",
    "39": "no one set of forces proves it, several do",
    "R1": "the height of the centre against the radius",
    "R2": "the same, in two directions",
    "R3": "the limit is 1 / (1/R + 1/r)",
    "R4": "no height helps a ball",
    "R5": "a bowl brings it back",
    "R6": "curvatures across each other",
    "R7": "stands by friction alone",
    "R8": "a limit in its plane; across it, it falls",
    "R9": "two lines of contact: it cannot roll, and needs no friction",
}


def asked(case: Case) -> list[float]:
    """The parameter, or one on each side of the limit."""
    return [0.0] if case.limit is None else [case.limit - BESIDE, case.limit + BESIDE]


def known(case: Case, words: dict[str, str]) -> str:
    """The state, or both with the limit between."""
    below = words.get(case.state, case.state)
    if case.limit is None or case.above is None:
        return below
    return f"{below} below {number(case.limit, 4)}, {words.get(case.above, case.above)} above"


def second_of(assembly: Assembly) -> SecondOrder | None:
    """What second order says of what stands to first."""
    verdict = kilter.check(assembly, effort=1)
    assert verdict.stable
    return verdict.second_order


def slippery(case: Case) -> tuple[list[str], list[bool]]:
    """The cells of a case without friction, and which of its states are found."""
    found = [second_of(case.build(at)) for at in asked(case)]
    states = ["" if one is None else one.state for one in found]
    first = found[0]
    assert first is not None
    cells = [known(case, {}), ", ".join(states), str(first.neutral), str(first.free)]
    return cells, [one == two for one, two in zip(states, (case.state, case.above), strict=False)]


def in_the_plane(assembly: Assembly) -> Assembly | None:
    """In the plane y = 0, where all contacts are at one point of it; else None."""
    points = {tuple(one.points[0][[0, 2]].tolist()) for one in assembly.contacts}
    if len(points) > 1:
        return None
    contacts = assembly.contacts[:1]
    return Assembly(assembly.parts, contacts=contacts, friction=GRIP, planar=True, detect=False)


def rolls(assembly: Assembly | None) -> str:
    """Whether friction holds it, as far as that is proved."""
    if assembly is None:
        return "-"
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return find_rolling(program, features_of(program, contacts)).state


def rests(assembly: Assembly) -> str:
    """Whether it holds without friction already."""
    second = kilter.check(assembly, effort=1).second_order
    return "holds" if second is not None and second.state in ("minimum", "free") else ""


def gripping(case: Case) -> list[str]:
    """The cells of a case that rolls."""
    built = [case.build(at) for at in asked(case)]
    flat = [rolls(in_the_plane(one)) for one in built]
    space = [rests(one) or rolls(one) for one in built]
    both = [", ".join(dict.fromkeys(found)) for found in (flat, space)]
    return [known(case, ROLLS), *both]


def row(case: Case, cells: list[str]) -> str:
    """A line of a table."""
    return "| " + " | ".join([case.number, case.title, *cells]) + " |\n"


def cards(cases: list[Case], words: dict[str, str]) -> str:
    """What is known of cases, with their pictures."""
    told = [
        CARD.format(
            number=case.number,
            title=case.title,
            heading=case.title[0].upper() + case.title[1:],
            known=known(case, words),
            shows=SHOWS[case.number][0].upper() + SHOWS[case.number][1:],
        )
        for case in cases
    ]
    return '<div class="grid cards" markdown>\n' + "".join(told) + "\n</div>\n"


def page() -> str:
    """The whole page."""
    without = [(case, *slippery(case)) for case in CASES]
    states = [one for _, _, found in without for one in found]
    missing = [case.number for case, _, found in without if not all(found)]
    left = f"open: {', '.join(missing)}" if missing else "none is open"
    return "".join(
        [
            HEAD.format(beside=number(BESIDE, 2)),
            SLIPPERY.format(
                signs=SIGNS, cards=cards(CASES, {}), found=sum(states), all=len(states), open=left
            ),
            *(row(case, cells) for case, cells, _ in without),
            GRIPPING.format(cards=cards(ROLLING, ROLLS)),
            *(row(case, gripping(case)) for case in ROLLING),
        ]
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
