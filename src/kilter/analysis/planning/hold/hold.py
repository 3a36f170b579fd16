"""`kilter.hold`: search for the fewest supports with which an assembly holds.

The candidates are grips, fingers, props, vacuum cups and magnets (`kilter.contact.supports`). The
answer includes the proof that fewer supports are not enough
(`kilter.analysis.planning.hold.least_supports`), except for the verdict "undecided".
"""

from __future__ import annotations

import time
from collections.abc import Iterable

from numpy.typing import ArrayLike

from kilter.analysis.decision.decision import Decision
from kilter.analysis.planning.hold.fixture import Fixture, StoppedMotion
from kilter.analysis.planning.hold.least_straps import find_least_straps
from kilter.analysis.planning.hold.least_supports import LeastSupports, find_least_supports
from kilter.analysis.planning.hold.support_candidates import candidates_of
from kilter.analysis.planning.hold.supported import Supported
from kilter.assembly import Strap
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.contact import detect
from kilter.contact.fits.suggestions import require_apart
from kilter.contact.supports import Support
from kilter.errors import InputError
from kilter.tell.levels import require_level
from kilter.work import Work

__all__ = ["hold"]

SEARCH = 36.0
"""Work of the search, relative to the work of an effort [-]; larger: longer searches.

At the default effort a search without result takes less than ten seconds of one core. With half of
this work, an assembly of 60 stones got 17 grips instead of 7."""


@question()
def hold(
    asked: Question,
    *,
    candidates: Iterable[str | Support] = ("grips",),
    straps: Iterable[Strap] | None = None,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    most: int | None = None,
) -> Fixture:
    """Find the fewest supports with which an assembly holds, and prove that fewer are not enough.

    Parameters
    ----------
    assembly : Assembly, or path
        Assembly; `Assembly.without` omits parts that are not inserted yet.
    candidates : iterable of "grips", "props", "fingers" or Support
        Candidates: a grip on every part, a prop under every part, a finger on every flat
        face that is free, or the given supports.
    straps : iterable of Strap, optional
        Candidates of the only kind, in place of `candidates`: the answer has the fewest of these
        straps beside those of the assembly. The proof is one of equilibrium.
    code : str, optional
        With `straps`: the same straps must hold the load at every acceleration of this code of load
        securing, as in `kilter.transport`.
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    most : int, optional
        Largest number of supports to consider.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. The assembly must reach it with its supports.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns the search
        of supports, too.

    Raises
    ------
    InputError
        If no candidate exists, a candidate does not fit the assembly, the code does not exist, or
        it is given without straps.

    See Also
    --------
    kilter.plan : parts that are held while the assembly is built.
    kilter.fastened : joints between parts.

    Examples
    --------
    >>> from kilter.scenes.arches import arch
    >>> half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    >>> hold(half)
    <Fixture: grip on voussoir-3, grip on voussoir-5>
    >>> hold(half, most=1)
    <Fixture: undecided, 2 or more>
    """
    assembly = asked.assembly
    if straps is None:
        require_no_bonds(assembly, "hold", NOT_SET)
        if code is not None:
            raise InputError(
                "a code of load securing needs candidate straps",
                hint="give straps=[...]",
                option="give them with --straps FILE.json",
            )
    asked = asked.but(require=require_level(asked.require))
    require = asked.require
    if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 0):
        raise InputError(f"most is {most!r:.40}", hint="give a whole number, 0 or more")
    work = asked.work(SEARCH)
    contacts = detect.touching(asked)
    require_apart(assembly, contacts)
    if straps is not None:
        return find_least_straps(
            assembly,
            contacts,
            tuple(straps),
            code=code,
            forward=forward,
            require=require,
            effort=asked.effort,
            tell=work.stage,
        )
    wanted = [candidates] if isinstance(candidates, str | Support) else candidates
    given = Supported(assembly, contacts, candidates_of(assembly, contacts, wanted))
    seconds = {"contacts": time.perf_counter() - asked.begun}
    return _by_supports(given, asked, work, most, seconds)


def _by_supports(
    given: Supported, asked: Question, work: Work, most: int | None, seconds: dict[str, float]
) -> Fixture:
    """The fixture with the fewest supports."""
    started, interrupted, require = time.perf_counter(), False, asked.require
    work.stage("the fewest supports")
    try:
        least = find_least_supports(given, work, most=most, require=require, effort=asked.effort)
    except KeyboardInterrupt:
        least, interrupted = LeastSupports(None, 0, None, ()), True
    state = least.state
    decision = None if state is None else state.decision
    stated = [] if state is None else [given.stated("held", state)]
    stated += [given.stated("not fewer", entry.state) for entry in least.motions]
    seconds["solve"] = time.perf_counter() - started
    return Fixture(
        level=None if decision is None else decision.level,
        require=require,
        why=_why(decision),
        supports=None if state is None else given.held(state),
        least=least.least,
        motions=tuple(
            StoppedMotion(
                stopped_by=tuple(given.supports[k].name for k in sorted(entry.shares)),
                moving=entry.state.moving,
            )
            for entry in least.motions
        ),
        most=most,
        judged=given.asked,
        exhausted=least.complete and not work.over and not interrupted,
        interrupted=interrupted,
        time_limit=asked.time_limit if work.cut else None,
        seconds={key: round(value, 6) for key, value in seconds.items()},
        assembly=given.assembly,
        contacts=given.contacts,
        offered=given.supports,
        chosen=None if state is None else tuple(sorted(state.chosen)),
        impossible=least.enough is False,
        stated=stated,
    )


def _why(decision: Decision | None) -> str | None:
    """Reason why the verdict level is only equilibrium, as in `Verdict.why`; else None."""
    if decision is None or decision.level != "equilibrium":
        return None
    if decision.verdict == "balanced":
        return "balanced"
    return None if decision.friction is None else decision.friction.why
