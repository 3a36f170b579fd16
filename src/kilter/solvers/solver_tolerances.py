"""Tolerances of the solvers; each relative to the numbers of the problem around it [-].

    NEGLIGIBLE_ENTRY < FEASIBLE < BOUNDED_FEASIBLE < BELIEVED < NEAR_BOUND < WIDE
    CONIC_FIRST < CONIC < QUADRATIC_GOOD < BELIEVED

A solver is asked for more digits than its answer is then believed to have; a bound is looked
for again where it is farther from the objective than what an answer is believed to.
"""

NEGLIGIBLE_ENTRY = 1e-12
"""Entries of a matrix below this are no entries to HiGHS; it would drop those below 1e-9."""
FEASIBLE = 1e-10
"""Feasibility asked of HiGHS, absolute in the program's own numbers: the least it takes."""
BOUNDED_FEASIBLE = 1e-9
"""The same where only a safe bound is wanted, which errs on the safe side whatever it is."""
BELIEVED = 1e-8
"""Residual up to which x and multipliers are optimal: violations and gaps beyond rounding."""
NEAR_BOUND = 1e-7
"""A safe bound this near the objective needs no second try."""
WIDE = 0.1
"""Gap and dual tolerance where only a feasible point is asked for."""

CONIC_FIRST = 1e-12
"""Gap and feasibility first asked of Clarabel for a quadratic program."""
CONIC = 1e-10
"""Gap and feasibility asked of Clarabel where there are cones."""
QUADRATIC_GOOD = 1e-9
"""Residual of a quadratic program that ends the search."""

LARGEST_POINT = 1e6
"""Sum of sizes of a feasible point up to which its absence has to be proved. Programs are
scaled so that one weight is 1: forces of a million weights are no equilibrium."""
EPSILON = 2.0**-52
"""Rounding of float64."""
