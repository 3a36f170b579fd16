"""Answers about friction: does it surely hold the assembly, may it, or is a motion possible?

Equilibrium forces in Coulomb's cones are necessary for parts to stay, but not sufficient: the
contact law may also allow a motion, with other forces. So further questions follow:

1. Does the weight itself press the contacts so that friction holds the assembly, if it is put
together with care (*seated*, `kilter.friction.seating`)? 2. Does the assembly come to rest however
loosely it is put down (*settles*, `kilter.friction.settling`)? 3. Does a motion obey the law as
well? A motion with its forces *refutes* the guarantee (`kilter.friction.motion_search`); then
settling does not count. 4. If no motion was found: can every motion be excluded
(`kilter.friction.exclusion`)? Then the assembly is stable, *proved*.

An assembly that is stable without friction is stable for every mu, since any solution of the
contact law has a.M a <= w.a, and w.a <= 0 for every admissible a.

The points of a patch are the corners of its hull. For equilibrium this loses nothing; for motion it
is a model of the pressure distribution, with the whole pressure at the corners.

References
----------
J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988. G. De Saxce,
Z.-Q. Feng, The bipotential method, 1998. J.-S. Pang, J. Trinkle, Stability characterizations of
rigid body contact problems with Coulomb friction, 2000.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.friction.exclusion import Exclusion, prove_no_motion
from kilter.friction.exclusion_file import exclusion_data
from kilter.friction.law import coulomb_law
from kilter.friction.motion_search import CoulombMotion, find_coulomb_motion
from kilter.friction.seating import Seating, find_seating
from kilter.friction.settling import TRIES, Settling, find_settling
from kilter.friction.spring_newton import SharedFactor, elastic_forces
from kilter.friction.springs import spring_system
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.program import Program
from kilter.mechanics.proof import Evidence
from kilter.tell.record import InPython, Record
from kilter.work import CONIC_ENTRY, EFFORT, PER_EFFORT, Work

SEATING = 2.0
"""Work of the search for a seat, in multiples of the effort, in addition to the motion search."""
SETTLING = 6.0
"""Work of the settling tries, in multiples of the effort, in addition to the motion search. Tries
that are not reached count as not passed. An arch of 1,000 voussoirs in space needs half of it, and
a leaning wall of 1,000 bricks a quarter."""
SEATING_POINT, SETTLING_POINT = 300.0, 800.0
"""Work of the same for each contact point, in addition. A leaning wall of 10,000 bricks needs half
of it."""
SEARCHED = 300
"""Number of contact points up to which an assembly that comes to rest in every try is searched for
other motions at the default effort. A larger number makes large walls slower, and may find more."""
EXCLUDING = 2.0
"""Work of the proof that no motion exists, over the work of the motion search. The proof follows
the starts of the search, which find most motions at once, and precedes its contact modes, which are
slow and needed only without a proof."""
EXCLUDING_IN_PLANE, EXCLUDING_FEW, FEW_POINTS = 0.8, 1.2, 60
"""In the plane, the same for assemblies of many contact points, for others, and the largest number
of points of the others. Proofs of arches of 20 under changed loads are found within the first or
are not found with half as much again; those of arches of 9 need up to the second."""
MODES = 0.6
"""Fraction of the work of the search after which no contact mode is examined: the modes that lead
to a motion are found in two thirds of that.
"""

CONIC_STEPS, ENTRIES_OF_POINT = 12, 6
"""Usual number of steps of a conic program, and number of its entries for each contact point and
freedom of a part.
"""

Answer = Literal["proved", "refuted", "open"]
Why = Literal["refuted", "jams", "squeeze", "not-found", "not-asked"]


class FrictionAnswer(Record, kw_only=False):
    """Guarantee of friction for a program in equilibrium, with the evidence for and against it."""

    guarantee: InPython[Answer]
    """No other motion obeys the contact law ("proved"); another motion does ("refuted"); or neither
    was shown ("open")."""
    witness: CoulombMotion | None
    """The motion that obeys the law, if refuted."""
    seating: Seating
    """Result of the search for a seat."""
    seat: InPython[ForceProof | None]
    """The verified forces of the seat, if seated."""
    settling: Settling
    """How each try (parts put down loosely) ended."""
    tries: InPython[tuple[ForceProof, ...]]
    """The verified forces of each try that came to balance."""
    exclusion: Exclusion | None
    """The proof that no motion exists, or its state when it stopped."""
    work: float
    """Units of work spent (`kilter.work`)."""
    examined: InPython[bool] = True
    """False if only the equilibrium was requested, or if the other questions exceed the work limit:
    then seating, settling and motions are unknown."""
    effort: float = EFFORT
    """Effort of the search for motions."""

    @property
    def settles(self) -> bool:
        """True if every settling try ended in verified balance and no motion was found."""
        return self.guarantee != "refuted" and len(self.tries) == self.settling.of

    @property
    def why(self) -> Why | None:
        """First reason why the assembly may not stay; None if it settles or is proved stable."""
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
        """The data of this answer that a proof file contains."""
        exclusion = self.exclusion
        return Evidence(
            self.guarantee,
            witness=None if self.witness is None else self.witness.law,
            settles=self.settles,
            exclusion=None
            if exclusion is None or not exclusion.proved
            else exclusion_data(exclusion),
        )


def not_asked(program: Program) -> FrictionAnswer:
    """Friction answer for callers that need only equilibrium: no search for motions is made.

    The guarantee covers Coulomb's law only, not bonds that bear shear up to a force.
    """
    no_forces = np.zeros((len(program.part_a), 3))
    seating = Seating("not-found", no_forces, np.inf, 0, 0, None)
    settling = Settling((), (), TRIES, 0)
    return FrictionAnswer("open", None, seating, None, settling, (), None, 0.0, examined=False)


def ask_friction(
    program: Program,
    *,
    work: Work | float = EFFORT,
    enough: str | None = None,
) -> FrictionAnswer:
    """Decide whether an assembly in equilibrium with friction stays, and try to prove it."""
    whole = Work.of(work)
    before = whole.total
    if enough == "proved":
        unknown = not_asked(program)
        seating, settling = unknown.seating, unknown.settling
    else:
        seating, settling = _seat_and_settle(program, whole)
    seats = _verify_forces(program, [seating.forces] if seating.seated == "yes" else [])
    tries = _verify_forces(program, settling.forces)

    def answer(
        guarantee: Answer, witness: CoulombMotion | None = None, exclusion: Exclusion | None = None
    ) -> FrictionAnswer:
        seat_proof = seats[0] if seats else None
        return FrictionAnswer(
            guarantee, witness, seating, seat_proof, settling, tries, exclusion, whole.spent
        )

    runaway = seating.runaway if seating.runaway is not None else settling.runaway
    settles = len(tries) == settling.of
    # the programs of a large assembly cost far more than its tries, and hardly any of those that
    # come to rest in every try have a motion
    enough_tries = settles and whole.allowed <= PER_EFFORT
    search = len(program.mu) <= SEARCHED or not (enough_tries or _out_of_reach(program, whole))
    if search:
        whole.stage("looking for a motion")
        witness = find_coulomb_motion(program, work=whole, runaway=runaway, only="starts")
        if witness is not None:
            return answer("refuted", witness)
    # beside a level that is reached already, a proof only saves the search of contact modes
    most = _excluding(program) * whole.allowed
    if enough == "settles" and settles:
        most = min(most, whole.total - before)
    exclusion = _exclude(program, whole.beside(most))
    if exclusion.proved:
        return answer("proved", exclusion=exclusion)
    if not search or enough == "proved" or (enough == "settles" and not settles):
        return answer("open", exclusion=exclusion)
    witness = find_coulomb_motion(program, work=whole.until(MODES), only="modes")
    return answer("open" if witness is None else "refuted", witness, exclusion)


def _exclude(program: Program, work: Work) -> Exclusion:
    """Try to prove that no motion exists, with a work limit of its own."""
    work.stage("excluding every motion")
    return prove_no_motion(program, work=work)


def _excluding(program: Program) -> float:
    """Work of the proof that no motion exists, over the work of the motion search."""
    if not program.planar:
        return EXCLUDING
    return EXCLUDING_FEW if len(program.mu) <= FEW_POINTS else EXCLUDING_IN_PLANE


def _out_of_reach(program: Program, whole: Work) -> bool:
    """True if a single conic program is already expected to exceed the work limit."""
    entries = program.part_a.size * ENTRIES_OF_POINT * len(program.freedoms)
    expected = CONIC_ENTRY * CONIC_STEPS * entries
    return expected > max(whole.allowed, PER_EFFORT) and bool(program.mu.any())


def _seat_and_settle(program: Program, whole: Work) -> tuple[Seating, Settling]:
    """Search for a seat (a state of rest), then put the parts down loosely in several tries."""
    law = coulomb_law(program)
    efforts = PER_EFFORT * max(whole.allowed / PER_EFFORT, 1.0)
    points = len(program.mu)
    whole.stage("seating")
    beside = whole.beside(SEATING * efforts + SEATING_POINT * points)
    moves = bool(len(law.load) and law.strength)
    factor = SharedFactor(spring_system(law)) if moves else None
    elastic = elastic_forces(law, work=beside, factor=factor) if moves else None
    seating = find_seating(program, work=beside, elastic=elastic, factor=factor)
    whole.stage("putting it down loosely")
    settling = find_settling(
        program,
        work=whole.beside(SETTLING * efforts + SETTLING_POINT * points),
        elastic=elastic,
        factor=factor,
    )
    return seating, settling


def _verify_forces(program: Program, forces: Sequence[Array]) -> tuple[ForceProof, ...]:
    """Equilibrium proofs from the given forces; forces that fail the check give none."""
    proofs = []
    for vectors in forces:
        along = np.einsum("ij,ij->i", vectors, program.normal)
        proof = check_forces(program, along, vectors - along[:, None] * program.normal)
        if proof.holds:
            proofs.append(proof)
    return tuple(proofs)
