"""Linear programs whose work is counted; none is solved once the work is over."""

from __future__ import annotations

from kilter.arrays import Array
from kilter.solvers.highs import find_optimum
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

__all__ = ["optimum"]


def optimum(program: LinearProgram, work: Work | None) -> Array | None:
    """Optimal solution of a linear program, shape (n,); None without one, or if work is over."""
    if work is None:
        work = Work()
    if work.over:
        return None
    answer = find_optimum(program, work=work)
    work.loaded(program.matrix.nnz)
    work.linear(answer.iterations, program.matrix.nnz)
    return answer.x if answer.optimal else None
