"""Adapters for plain linear programs, and a single factorisation as lower bound.

    find f >= 0 with J^T f + w = 0

The programs are in SI units without scaling; each friction cone is an inner pyramid of `SIDES`
rays. Both solvers have default settings, and their status is the answer.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from question import Question

SIDES = 8


def balance(question: Question) -> tuple[Any, Any]:
    """J^T for the rays of the pyramids, sparse by columns, and -w."""
    from kilter.mechanics.coulomb_cones import pyramid

    program = question.program
    rays = pyramid(program, SIDES)
    return rays.jacobian().T.tocsc(), -program.load[program.free][:, program.freedoms].ravel()


def linprog(question: Question) -> Callable[[], tuple[str, str]]:
    """`scipy.optimize.linprog`, whose solver is HiGHS."""
    from scipy.optimize import linprog as solve

    matrix, right = balance(question)
    cost = np.zeros(matrix.shape[1])

    def run() -> tuple[str, str]:
        found = solve(cost, A_eq=matrix, b_eq=right, bounds=(0, None), method="highs")
        word = {0: "holds", 2: "falls"}.get(found.status, "open")
        return word, f"status {found.status}"

    return run


def highs(question: Question) -> Callable[[], tuple[str, str]]:
    """HiGHS through highspy."""
    import highspy

    matrix, right = balance(question)

    def run() -> tuple[str, str]:
        model = highspy.HighsLp()
        model.num_row_, model.num_col_ = matrix.shape
        model.col_cost_ = np.zeros(matrix.shape[1])
        model.col_lower_ = np.zeros(matrix.shape[1])
        model.col_upper_ = np.full(matrix.shape[1], highspy.kHighsInf)
        model.row_lower_ = model.row_upper_ = right
        model.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        model.a_matrix_.start_ = matrix.indptr
        model.a_matrix_.index_ = matrix.indices
        model.a_matrix_.value_ = matrix.data
        solver = highspy.Highs()
        solver.setOptionValue("output_flag", False)
        solver.passModel(model)
        solver.run()
        status = solver.getModelStatus()
        kinds = highspy.HighsModelStatus
        word = {kinds.kOptimal: "holds", kinds.kInfeasible: "falls"}.get(status, "open")
        return word, solver.modelStatusToString(status)

    return run


def factorisation(question: Question) -> Callable[[], tuple[str, str]]:
    """A sparse factorisation of J^T J: no answer, but a step that every solver needs."""
    sys.path.append(str(Path(__file__).resolve().parents[1]))
    from walls import factorise

    program = question.program

    def run() -> tuple[str, str]:
        factorise(program)
        return "", ""

    return run
