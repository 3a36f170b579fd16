"""Coulomb's law: which motions obey it, and whether any does.

`kilter.friction.answer.ask_friction` asks all there is to ask of a program whose forces of
equilibrium exist; `kilter.friction.motion_search.find_coulomb_motion` finds a motion that obeys
the law, also where they do not. Below these two, in the order in which they are read:

    law                   the law in scaled unknowns, the one scaling of all
    branching             contact modes, and branch and bound over them
    seating               does its own weight make the forces that hold it?
    motion_search         De Saxce's iteration; what polish and mode_search add to it
    polish                a nearly right motion made exact, mode by mode
    near_law              which candidates are worth it, and worth an exact judgement
    mode_search           motions by branch and bound

    reduced_law           the law with joints eliminated and points grouped
    force_bound, opening_motion
                          a motion that bounds all forces
    moment_forms, moment_products, moment_bound, moments
                          products of the law, and what they leave of the power without cases
    enclosure             bounds of all solutions, and cones of twists
    template, relaxation  the linear program that contains all solutions
    contraction           bounds shrunk by linear programs
    exclusion_cases       branch and bound until no case is left
    exclusion             the proof that no motion can start; exclusion_steps what it is made of
    exclusion_bounds      what follows from multipliers, whoever found them
    exclusion_check, exclusion_file
                          the proof repeated without a solver; the proof as data

    friction_tolerances   every tolerance, and how they stand to one another
"""
