"""Linear programs that are charged to a work limit; none is solved once it is spent."""

from __future__ import annotations

from kilter.arrays import Array
from kilter.solvers.highs import find_optimum
from kilter.solvers.problem import LinearProgram
from kilter.work import Work


def optimum(program: LinearProgram, work: Work | None) -> Array | None:
    """Optimal point of a linear program, shape (n,); None without one, or without work left."""
    if work is None:
        work = Work()
    if work.over:
        return None
    answer = find_optimum(program, work=work)
    work.loaded(program.matrix.nnz)
    work.linear(answer.iterations, program.matrix.nnz)
    return answer.x if answer.optimal else None
