"""Coulomb's law: search for motions that obey it, and proofs that no motion obeys it.

`kilter.friction.answer.ask_friction` answers all questions of friction for a program that has
forces of equilibrium. `kilter.friction.motion_search.find_coulomb_motion` finds a motion that obeys
the law, also for programs without such forces. The other modules, in reading order:

    law                   the law in scaled unknowns, with the scaling that all modules share
    branching             contact modes, and branch and bound over them
    springs               contacts that give a little, and the balance of the parts
    elastic_forces        forces of equilibrium of the least elastic energy
    relaxing              the path of parts to rest, in pseudo-time
    seating               does the weight itself produce the forces that hold the assembly?
    settling              does the assembly come to rest if it is put down loosely?
    motion_search         De Saxce's iteration, completed by polish and mode_search
    polish                Newton's method that makes a nearly admissible motion exact
    near_law              a cheap test of which candidates deserve an exact check
    mode_search           motions by branch and bound

    reduced_law           the law with joints eliminated and points grouped
    force_bound, opening_motion
                          a motion that bounds all contact forces
    moment_forms, moment_products, moment_bound, moments
                          products of the law, and the power that they leave without cases
    enclosure             bounds of all solutions, and cones of twists
    template, relaxation  the linear program that contains all solutions
    contraction           bounds shrunk by linear programs
    exclusion_cases       branch and bound until no case is left
    exclusion             the proof that no motion can start; exclusion_steps has its steps
    exclusion_bounds      bounds that follow from given multipliers, without a solver
    exclusion_check, exclusion_file
                          the proof repeated without a solver; the proof as data

    friction_tolerances   all tolerances, and their order
"""
