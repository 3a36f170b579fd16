"""The page of known answers of second order: ``python docs/build_known_answers.py``.

`tests/scenes/balance_cases.py` has the known states. `kilter.check` and `find_rolling` compute
the states on both sides of each limit. `SHOWS` has a remark on each case.
"""

from __future__ import annotations

import sys
from pathlib import Path

import kilter
from kilter.assembly import Assembly
from kilter.mechanics.program import build_program
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.motions.rolling import find_rolling
from kilter.tell.numbers import number

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from balance_cases import CASES, GRIP, ROLLING, Case

PAGE = Path(__file__).resolve().parent / "contributing/known-answers.md"
BESIDE = 0.1
"""Distance from a limit at which both sides are computed [unit of the parameter]."""
ROLLS = {"minimum": "holds", "balanced": "falls"}

HEAD = """# Known answers of second order

To first order each of these assemblies stands, and the rolling cases stand by friction: forces of
equilibrium exist, and no motion gains energy at once. The result of second order is known for
each case, from a closed form or by hand. The tests compare kilter on both sides of every limit.
`python docs/build_known_answers.py` computes this page.
The [theory](methods/theory.md) has the proofs,
the [glossary](../reference/glossary.md) defines the words.

The cases are in `tests/scenes/balance_cases.py`. Their contacts are given with their
[features](../explanation/contacts.md#features). The pictures are drawn from these,
and choose dimensions that a case leaves open, such as the thickness of a plank.
If a case has a limit, the first state is
{beside} below it and the second state is {beside} above it. *Neutral* counts the motions that
cost no energy to first order. *Free* counts those that provably cost no energy at all, below the
limit. Lengths are in m.

"""
SLIPPERY = """## Without friction

The states are [minimum](../reference/glossary.md#minimum),
[free](../reference/glossary.md#free) and
[balanced](../reference/glossary.md#balanced). Spins of round parts do not count against a minimum.

{signs}
{cards}
kilter finds {found} of {all} states; {open}.

| | case | known | kilter finds | neutral | free |
|---|---|---|---|---|---|
"""
SIGNS = """Held parts are striped. A quartered circle marks a centre of mass below the limit; a
dashed line marks its height at the limit. An orange arrow away from the part shows a fall. Two
blue arrows towards the part show that it returns after a push. Two plain arrows away from the
part show free motion.
"""
CARD = """
-   ![{number}: {title}](../images/known/{number}.svg){{ loading=lazy }}

    **{number}. {heading}:** {known}. {shows}.
"""
GRIPPING = """
## Rolling without slip

With friction, and without slip, these assemblies roll. *Holds* means that a part rolls back,
*falls* that it rolls off. If all contacts lie at a single point of a plane, the case is also
examined in that plane, in which rolling has a single dimension. In space, a part that rolls in a
circle may come back shifted. If no energy bounds the sum of these shifts, the answer is *open*
([theory](methods/theory.md)).
A state that is a minimum or free without friction also holds with friction.

{cards}
| | case | known | in the plane | in space |
|---|---|---|---|---|
"""

SHOWS = {
    "01": "Two shifts and three turns are free",
    "02": "The simplest balanced case",
    "03": "The ball rolls back; its spins are free",
    "04": "A single direction in which the ground descends is enough to make it fall",
    "05": "The ball slides along the trough, and spins",
    "06": "The ball stays in the line of the two balls, but falls to the side",
    "07": "Only spins remain",
    "08": "It stands on its shortest axis only",
    "09": "The limit is the height of the centre of the sphere",
    "10": "The limit is the height of the axis of the round edge",
    "11": "The box slides off, however low its centre",
    "12": "The upper cylinder slides off on either side",
    "13": "Five points represent the line of contact, so the forces are not unique",
    "14": "After a push the cylinder rolls back; it slides freely along the trough",
    "15": "The pair turns about the tube",
    "16": "The walls leave only spins",
    "17": "No motion opens both plates: the path keeps them",
    "18": "No part supports it sideways",
    "19": "The ends slide down as the plank turns",
    "20": "The limit is minus the tangent of the slope",
    "21": "The ring hangs, and slips round",
    "22": "As a ring on a peg, but with the centre of mass at any height",
    "23": "It falls as a coin on its rim does",
    "24": "The box slides out as it tips",
    "24b": "As the case before, but the box cannot slide out",
    "25": "A pendulum, hanging or inverted",
    "26": "It spins about its axis, and turns about the vertical",
    "27": "The axis does not pass through the centre of mass",
    "28": "Many contacts, and only spins remain",
    "29": "The ball falls across the cylinder, and rolls along it",
    "30": "The ball comes back across the pipe, and rolls along it",
    "31": "The ring holds the ball in its plane, but not sideways",
    "32": "The coin falls flat",
    "33": "Two level shifts and a turn",
    "34": "The free motions move all four parts at once",
    "35": "Three level motions of each box",
    "36": "The plank tips about the line of the two balls",
    "37": "Across the row it rocks as a weeble; along the row it cannot tip",
    "38": "No motion is free",
    "39": "No single set of forces proves it, but several sets do",
    "R1": "The limit is the radius of the cylinder",
    "R2": "The limit is the radius of the ball, in both directions",
    "R3": "The limit is 1 / (1/R + 1/r)",
    "R4": "No height helps a ball",
    "R5": "A bowl brings it back",
    "R6": "The curvatures lie across each other",
    "R7": "It stands by friction alone",
    "R8": "The limit holds in its plane; out of the plane it falls",
    "R9": "Two lines of contact: it cannot roll, and needs no friction",
}


def parameters(case: Case) -> list[float]:
    """The parameter, or a parameter on each side of the limit."""
    return [0.0] if case.limit is None else [case.limit - BESIDE, case.limit + BESIDE]


def known(case: Case, words: dict[str, str]) -> str:
    """Words for the known state, or for both states and the limit between them."""
    below = words.get(case.state, case.state)
    if case.limit is None or case.above is None:
        return below
    return f"{below} below {number(case.limit, 4)}, {words.get(case.above, case.above)} above"


def second_of(assembly: Assembly) -> SecondOrder | None:
    """Second order of an assembly that is stable to first order."""
    verdict = kilter.check(assembly, effort=1)
    assert verdict.first_order == "stable"
    return verdict.second_order_answer


def slippery(case: Case) -> tuple[list[str], list[bool]]:
    """Cells of a case without friction, and for each state whether kilter finds it."""
    answers = [second_of(case.build(at)) for at in parameters(case)]
    states = ["" if answer is None else answer.state for answer in answers]
    first = answers[0]
    assert first is not None
    cells = [known(case, {}), ", ".join(states), str(first.neutral), str(first.free)]
    expected = (case.state, case.above)
    return cells, [state == right for state, right in zip(states, expected, strict=False)]


def in_the_plane(assembly: Assembly) -> Assembly | None:
    """Assembly in the plane y = 0 if all contacts are at the same point of it; else None."""
    points = {tuple(contact.points[0][[0, 2]].tolist()) for contact in assembly.contacts}
    if len(points) > 1:
        return None
    contacts = assembly.contacts[:1]
    return Assembly(assembly.parts, contacts=contacts, friction=GRIP, planar=True, detect=False)


def rolls(assembly: Assembly | None) -> str:
    """State of rolling with friction, "-" without an assembly."""
    if assembly is None:
        return "-"
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return find_rolling(program, features_of(program, contacts), assembly).state


def rests(assembly: Assembly) -> str:
    """Word "holds" if the assembly already holds without friction, else empty."""
    second = kilter.check(assembly, effort=1).second_order_answer
    return "holds" if second is not None and second.state in ("minimum", "free") else ""


def gripping(case: Case) -> list[str]:
    """Cells of a rolling case."""
    assemblies = [case.build(at) for at in parameters(case)]
    flat = [rolls(in_the_plane(assembly)) for assembly in assemblies]
    space = [rests(assembly) or rolls(assembly) for assembly in assemblies]
    both = [", ".join(dict.fromkeys(states)) for states in (flat, space)]
    return [known(case, ROLLS), *both]


def row(case: Case, cells: list[str]) -> str:
    """A line of a table."""
    return "| " + " | ".join([case.number, case.title, *cells]) + " |\n"


def cards(cases: list[Case], words: dict[str, str]) -> str:
    """Cards of the cases: picture, known states and a remark."""
    texts = [
        CARD.format(
            number=case.number,
            title=case.title,
            heading=case.title[0].upper() + case.title[1:],
            known=known(case, words),
            shows=SHOWS[case.number],
        )
        for case in cases
    ]
    return '<div class="grid cards" markdown>\n' + "".join(texts) + "\n</div>\n"


def page() -> str:
    """The whole page."""
    without = [(case, *slippery(case)) for case in CASES]
    states = [right for _, _, found in without for right in found]
    missing = [case.number for case, _, found in without if not all(found)]
    left = f"open: {', '.join(missing)}" if missing else "no case is open"
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
