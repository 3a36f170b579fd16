"""Tolerances of the solvers; each is relative to the numbers of the problem [-].

    NEGLIGIBLE_ENTRY < FEASIBLE < BOUNDED_FEASIBLE < BELIEVED < NEAR_BOUND < WIDE
    CONIC_FIRST < CONIC < QUADRATIC_GOOD < BELIEVED

The requested accuracy is finer than the accuracy that answers are assumed to have. A bound is
computed again if its distance from the objective exceeds the accuracy of an answer.
"""

NEGLIGIBLE_ENTRY = 1e-12
"""Matrix entries below this value are dropped by HiGHS, whose default is 1e-9."""
FEASIBLE = 1e-10
"""Feasibility requested from HiGHS, absolute in the program's numbers: the least that it
accepts.
"""
BOUNDED_FEASIBLE = 1e-9
"""Feasibility requested if only a safe bound is needed, which is valid at any accuracy."""
BELIEVED = 1e-8
"""Largest residual of x and multipliers that count as optimal. A larger value accepts less exact
solutions.
"""
NEAR_BOUND = 1e-7
"""A safe bound within this distance of the objective needs no second attempt."""
WIDE = 0.1
"""Gap and dual tolerance if only a feasible point is needed."""

CONIC_FIRST = 1e-12
"""First gap and feasibility requested from Clarabel for a quadratic program."""
CONIC = 1e-10
"""Gap and feasibility requested from Clarabel for a program with cones."""
QUADRATIC_GOOD = 1e-9
"""Residual of a quadratic program at which the attempts end."""

LARGEST_POINT = 1e6
"""Sum of absolute values up to which the absence of a feasible point must be proved. Programs are
scaled so that a weight is 1: forces of a million weights are no equilibrium.
"""
EPSILON = 2.0**-52
"""Rounding unit of float64."""
