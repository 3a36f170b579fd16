"""Friction: what must hold, what may, and what cannot.

Equilibrium forces within Coulomb's cones are necessary for parts to stay, not sufficient: the
contact law may allow a motion as well, with other forces. So three questions after the first:

1. Is there a motion that obeys the law too? One that is found, with its forces, *refutes*
   the guarantee (`kilter.friction.motion_search`).
2. Does its own weight press the contacts so that friction holds it (*seated*,
   `kilter.friction.seating`)?
3. If none was found: can every motion be excluded (`kilter.friction.exclusion`)? Then it is
   stable, *proved*.

What is stable without friction is stable for every mu, since any solution of the contact law
has a.M a <= w.a, and w.a <= 0 for every admissible a.

The points of a patch are the corners of its hull. For equilibrium nothing is lost by that;
for motion it is a model of the pressure inside the patch: all of it at the corners.

References
----------
J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988.
G. De Saxce, Z.-Q. Feng, The bipotential method, 1998. J.-S. Pang, J. Trinkle, Stability
characterizations of rigid body contact problems with Coulomb friction, 2000.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.friction.exclusion import Exclusion, prove_no_motion
from kilter.friction.motion_search import CoulombMotion, find_coulomb_motion
from kilter.friction.seating import Seating, find_seating
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.program import Program
from kilter.work import EFFORT, PER_EFFORT, Work

__all__ = ["FrictionAnswer", "ask_friction"]

SEATING = 0.1
"""Units of seating, over those of one effort, after which no new start of it is made."""
ROUNDS = ((0.15, 0.45), (0.65, 1.0))
"""Fractions of the work at which the search of a motion ends, and the proof after it, in two
rounds. Most assemblies are decided in the first, by a short search or a short proof; what is
left needs long ones, and which of the two is not known before."""

Answer = Literal["proved", "refuted", "open"]


@dataclass(frozen=True, slots=True, eq=False)
class FrictionAnswer:
    """What friction guarantees where equilibrium forces exist.

    Attributes
    ----------
    guarantee : {"proved", "refuted", "open"}
        There is no other motion that obeys the contact law; there is; neither was shown.
    witness : CoulombMotion or None
        The motion that obeys the law, where refuted.
    seating : Seating
    seat : ForceProof or None
        The forces that seat it, judged; where seated.
    exclusion : Exclusion or None
        The proof that there is no motion, or how far it came.
    work : float
        Units spent (`kilter.work`).
    """

    guarantee: Answer
    witness: CoulombMotion | None
    seating: Seating
    seat: ForceProof | None
    exclusion: Exclusion | None
    work: float

    @property
    def seated(self) -> bool:
        """Its own weight makes the forces that hold it."""
        return self.seat is not None


def ask_friction(
    program: Program,
    *,
    work: Work | float = EFFORT,
) -> FrictionAnswer:
    """Guarantee and seating of a program whose cones hold forces of equilibrium.

    Parameters
    ----------
    program : Program
        With friction; not stable without it.
    work : Work or float
        For the search and the proof together, or an effort.
    """
    whole = Work.of(work)
    whole.stage("seating")
    seating = find_seating(program, work=whole.beside(SEATING * PER_EFFORT))
    seat = _seat(program, seating)

    def answer(
        guarantee: Answer, witness: CoulombMotion | None = None, exclusion: Exclusion | None = None
    ) -> FrictionAnswer:
        return FrictionAnswer(guarantee, witness, seating, seat, exclusion, whole.spent)

    exclusion, searched = None, False
    for search_until, proof_until in ROUNDS:
        if not searched:
            whole.stage("looking for a motion")
            part = whole.until(search_until)
            witness = find_coulomb_motion(program, work=part, runaway=seating.runaway)
            if witness is not None:
                return answer("refuted", witness)
            # a search that ended before its time would find the same again: nothing
            searched = not part.over
        whole.stage("excluding every motion")
        exclusion = prove_no_motion(program, work=whole.until(proof_until))
        if exclusion.proved:
            return answer("proved", exclusion=exclusion)
    return answer("open", exclusion=exclusion)


def _seat(program: Program, seating: Seating) -> ForceProof | None:
    """The forces that seat it, where they pass as a proof of equilibrium."""
    if not seating.seated:
        return None
    along = np.einsum("ij,ij->i", seating.forces, program.normal)
    across = seating.forces - along[:, None] * program.normal
    judged = check_forces(program, along, across)
    return judged if judged.holds else None
