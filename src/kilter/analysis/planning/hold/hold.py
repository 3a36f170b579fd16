"""`kilter.hold`: search for the fewest supports with which an assembly holds.

The candidates are grips, fingers, props, vacuum cups and magnets (`kilter.contact.supports`). The
answer includes the proof that fewer supports are not enough
(`kilter.analysis.planning.hold.least_supports`), except for the verdict "undecided".
"""

from __future__ import annotations

import time
from collections.abc import Iterable

from numpy.typing import ArrayLike

from kilter.analysis.check import check
from kilter.analysis.planning.hold.fixture import Fixture
from kilter.analysis.planning.hold.lashing import Lashing
from kilter.analysis.planning.hold.least_straps import find_least_straps
from kilter.analysis.planning.hold.least_supports import LeastSupports, find_least_supports
from kilter.analysis.planning.hold.support_candidates import candidates_of
from kilter.analysis.planning.hold.supported import Supported
from kilter.assembly import Assembly, Strap
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.contact.fits.coincident import require_apart
from kilter.contact.supports import Support
from kilter.errors import InputError
from kilter.tell.levels import require_level

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
) -> Fixture | Lashing:
    """Find the fewest supports with which an assembly holds, and prove that fewer are not enough.

    Parameters
    ----------
    assembly : Assembly, or path
        Assembly; `Assembly.without` omits parts that are not inserted yet.
    candidates : iterable of "grips", "props", "fingers" or Support
        Candidates: a grip on every part, a prop under every part, a finger on every flat
        face that is free, or the given supports.
    straps : iterable of Strap, optional
        Candidates of the only kind, in place of `candidates`: the answer is a `Lashing`, the fewest
        of these straps beside those of the assembly. The proof is one of equilibrium.
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
    require = require_level(asked.require)
    if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 0):
        raise InputError(f"most is {most!r:.40}", hint="give a whole number, 0 or more")
    work, started = asked.work(SEARCH), time.perf_counter()
    contacts = detect.touching(asked)
    require_apart(assembly, contacts)
    seconds = {"contacts": time.perf_counter() - started}
    between = time.perf_counter()
    if straps is not None:

        def level_of(lashed: Assembly, touching: ContactSet) -> str | None:
            return check(lashed, contacts=touching, require=require, effort=asked.effort).level

        return find_least_straps(
            assembly,
            contacts,
            tuple(straps),
            code=code,
            forward=forward,
            require=require,
            level_of=level_of,
            progress=asked.progress,
        )
    wanted = [candidates] if isinstance(candidates, str | Support) else candidates
    given = Supported(assembly, contacts, candidates_of(assembly, contacts, wanted))
    work.stage("the fewest supports")
    interrupted = False
    try:
        least = find_least_supports(given, work, most=most, require=require, effort=asked.effort)
    except KeyboardInterrupt:
        least, interrupted = LeastSupports(None, 0, None, ()), True
    seconds["solve"] = time.perf_counter() - between
    return Fixture(
        supported=given,
        found=least,
        most=most,
        require=require,
        time_limit=asked.time_limit if work.cut else None,
        interrupted=interrupted,
        exhausted=least.complete and not work.over and not interrupted,
        seconds=seconds,
    )
