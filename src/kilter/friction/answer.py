"""Friction: what must hold, what may, and what cannot.

Equilibrium forces within Coulomb's cones are necessary for parts to stay, not sufficient: the
contact law may allow a motion as well, with other forces. So questions after the first:

1. Does its own weight press the contacts so that friction holds it, if it is put there with
   care (*seated*, `kilter.friction.seating`)?
2. Does it come to rest however loosely it is put down (*settles*,
   `kilter.friction.settling`)?
3. Is there a motion that obeys the law too? One that is found, with its forces, *refutes*
   the guarantee (`kilter.friction.motion_search`), and then it does not count that it settles.
4. If none was found: can every motion be excluded (`kilter.friction.exclusion`)? Then it is
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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.friction.elastic_forces import elastic_forces
from kilter.friction.exclusion import Exclusion, prove_no_motion
from kilter.friction.exclusion_file import exclusion_data
from kilter.friction.law import coulomb_law
from kilter.friction.motion_search import CoulombMotion, find_coulomb_motion
from kilter.friction.seating import Seating, find_seating
from kilter.friction.settling import TRIES, Settling, find_settling
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.program import Program
from kilter.mechanics.proof import Evidence
from kilter.work import EFFORT, PER_EFFORT, Work

__all__ = ["FrictionAnswer", "Why", "ask_friction", "not_asked"]

SEATING = 2.0
"""Efforts of seating, beside those of the search."""
SETTLING = 4.0
"""Efforts of settling, beside those of the search: tries that are not made when it is spent are
not passed. An arch of 100 voussoirs in space takes half of it."""
EXCLUDING = 2.0
"""Efforts of the proof that there is no motion, beside those of the search: it comes after the
starts of the search, which find most motions at once, and before its contact modes, which take
long and are needed where no proof exists."""
MODES = 0.6
"""Fraction of the work of the search after which no contact mode is looked at: those that lead
to a motion are found in two thirds of that."""

Answer = Literal["proved", "refuted", "open"]
Why = Literal["refuted", "jams", "squeeze", "not-found", "not-asked"]


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
    settling : Settling
    tries : tuple of ForceProof
        The forces of each try that came to balance, judged.
    exclusion : Exclusion or None
        The proof that there is no motion, or how far it came.
    work : float
        Units spent (`kilter.work`).
    examined : bool
        False if only the equilibrium was requested: then seating, settling and motions are unknown.
    """

    guarantee: Answer
    witness: CoulombMotion | None
    seating: Seating
    seat: ForceProof | None
    settling: Settling
    tries: tuple[ForceProof, ...]
    exclusion: Exclusion | None
    work: float
    examined: bool = True

    @property
    def settles(self) -> bool:
        """It came to balance in every try, by forces that are judged, and no motion was found."""
        return self.guarantee != "refuted" and len(self.tries) == self.settling.of

    @property
    def why(self) -> Why | None:
        """Why it may not stay, the first that applies; None where it settles or is proved."""
        if not self.examined:
            return "not-asked"
        if self.guarantee == "refuted":
            return "refuted"
        if self.guarantee == "proved" or self.settles:
            return None
        if self.seat is not None:
            return "jams" if self.settling.runs_away else "not-found"
        return "squeeze" if self.seating.seated == "runs-away" else "not-found"

    @property
    def evidence(self) -> Evidence:
        """What a proof file says of it."""
        exclusion = self.exclusion
        return Evidence(
            self.guarantee,
            witness=None if self.witness is None else self.witness.law,
            seated=self.seat,
            tries=self.tries,
            of=self.settling.of,
            exclusion=None
            if exclusion is None or not exclusion.proved
            else exclusion_data(exclusion),
        )


def not_asked(program: Program) -> FrictionAnswer:
    """Return the answer that forces of equilibrium exist; the guarantee is not examined.

    The guarantee covers Coulomb's law only, not bonds that bear shear up to a force.
    """
    none = np.zeros((len(program.part_a), 3))
    seating = Seating("not-found", none, np.inf, 0, 0, None)
    settling = Settling((), (), TRIES, 0)
    return FrictionAnswer("open", None, seating, None, settling, (), None, 0.0, examined=False)


def ask_friction(
    program: Program,
    *,
    work: Work | float = EFFORT,
) -> FrictionAnswer:
    """Guarantee, seating and settling of a program whose cones hold forces of equilibrium.

    Parameters
    ----------
    program : Program
        With friction; not stable without it.
    work : Work or float
        For the search and the proof together, or an effort.
    """
    whole = Work.of(work)
    seating, settling = _put_down(program, whole)
    seat = _judged(program, [seating.forces] if seating.seated == "yes" else [])
    tries = _judged(program, settling.forces)

    def answer(
        guarantee: Answer, witness: CoulombMotion | None = None, exclusion: Exclusion | None = None
    ) -> FrictionAnswer:
        first = seat[0] if seat else None
        return FrictionAnswer(
            guarantee, witness, seating, first, settling, tries, exclusion, whole.spent
        )

    runaway = seating.runaway if seating.runaway is not None else settling.runaway
    whole.stage("looking for a motion")
    witness = find_coulomb_motion(program, work=whole, runaway=runaway, only="starts")
    if witness is not None:
        return answer("refuted", witness)
    whole.stage("excluding every motion")
    exclusion = prove_no_motion(program, work=whole.beside(EXCLUDING * whole.allowed))
    if exclusion.proved:
        return answer("proved", exclusion=exclusion)
    witness = find_coulomb_motion(program, work=whole.until(MODES), only="modes")
    return answer("open" if witness is None else "refuted", witness, exclusion)


def _put_down(program: Program, whole: Work) -> tuple[Seating, Settling]:
    """With care, and loosely."""
    law = coulomb_law(program)
    efforts = PER_EFFORT * max(whole.allowed / PER_EFFORT, 1.0)
    whole.stage("seating")
    beside = whole.beside(SEATING * efforts)
    elastic = elastic_forces(law, work=beside) if len(law.load) and law.strength else None
    seating = find_seating(program, work=beside, elastic=elastic)
    whole.stage("putting it down loosely")
    settling = find_settling(program, work=whole.beside(SETTLING * efforts), elastic=elastic)
    return seating, settling


def _judged(program: Program, forces: Sequence[Array]) -> tuple[ForceProof, ...]:
    """Forces that pass as a proof of equilibrium."""
    found = []
    for one in forces:
        along = np.einsum("ij,ij->i", one, program.normal)
        judged = check_forces(program, along, one - along[:, None] * program.normal)
        if judged.holds:
            found.append(judged)
    return tuple(found)
