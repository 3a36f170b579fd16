"""Linear programs whose work is counted, and that are not solved once the work is over."""

from __future__ import annotations

from kilter.arrays import Array
from kilter.solvers.highs import find_optimum
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

__all__ = ["optimum"]


def optimum(program: LinearProgram, work: Work | None) -> Array | None:
    """An optimal solution, shape (n,); None if there is none, or the work is over."""
    if work is None:
        work = Work()
    if work.over:
        return None
    answer = find_optimum(program, work=work)
    work.loaded(program.matrix.nnz)
    work.linear(answer.iterations, program.matrix.nnz)
    return answer.x if answer.optimal else None
