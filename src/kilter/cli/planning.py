"""The command `plan`: orders of assembly."""

from __future__ import annotations

from kilter.cli.asked import Asked
from kilter.cli.exit_codes import HOLDS, INTERRUPTED, LOWER, PLAN
from kilter.cli.options import asks
from kilter.cli.order_files import written
from kilter.cli.output import Progress
from kilter.cli.plan_options import PlanOptions

__all__ = ["plan"]


@asks(searches=True, proves=True, writes=(".html", ".htm", ".svg", ".png", ".pdf", ".glb"))
def plan(asked: Asked, options: PlanOptions) -> int:
    """Find an order in which an assembly can be put together, and the parts to hold at each step.

    Grounded parts stand from the start. Every step is proved: forces hold the standing parts while
    the next part comes in along a free path of one or two straight pieces.

    With -o FILE.html a page that plays the steps is written, with -o FILE.glb a film for other
    programs, with -o FILE.svg, .png or .pdf a sheet of pictures, with -o FILE.csv a table for a
    robot.

    Exit code: 0 found, with every step at the level of --require; 3 found, with steps at a lower
    level; 1 proved that no order exists, or that the order of --sequence fails; 4 none found, which
    proves nothing.
    """
    from kilter.analysis.planning.order.plan import plan as find

    typed = options.typed()
    with Progress(asked.quiet) as progress:
        assembly, contacts = asked.read(progress)
        order = find(
            assembly,
            options.rules(assembly.gravity),
            require=options.require,
            **asked.shared(find, contacts, progress),
        )
    answer = order.to_dict()
    proved = order.verdict in ("found", "impossible")
    after = asked.keep_proof(order.proof if proved else None, answer)
    if asked.output is None or not written(order, answer, asked, typed):
        asked.tell(answer, after=after, typed=typed)
    if order.interrupted:
        return INTERRUPTED
    return PLAN[order.verdict] if not order.found else HOLDS if order.holds else LOWER
