"""Time-optimal speed along a path on which nothing slides or tips, with TOPPRA and with Drake.

    pip install toppra drake
    python examples/fastest_carrying.py

A tray with a stack of two boxes follows a curve. kilter computes linear constraints on the speed at
each sample, A (u, x) <= b with u = s'' and x = s'^2. TOPPRA finds the fastest s(t) by reachable
sets, Drake the largest sum of x by a linear program. Each runs if its package is installed.
"""

from __future__ import annotations

import importlib.util

import numpy as np

import kilter
from kilter import Assembly, Box, CarrierPath, Part, Pose
from kilter.analysis.transport.carrier_path import path_from_poses

SAMPLES = np.linspace(0.0, 1.0, 41)


def tray() -> Assembly:
    """A flat box and an upright box on it, friction 0.4."""
    return Assembly(
        [
            Part("tray", Box([0.6, 0.6, 0.02]), Pose([0, 0, -0.01]), grounded=True),
            Part("book", Box([0.3, 0.2, 0.05]), Pose([0, 0, 0.025]), mass=0.8),
            Part("cup", Box([0.06, 0.06, 0.2]), Pose([0.05, 0, 0.15]), mass=0.3),
        ],
        friction=0.4,
    )


def curve() -> np.ndarray:
    """Positions of the tray [m]: an arc in plan that also rises."""
    angle = np.pi * SAMPLES
    return np.column_stack([0.8 * np.sin(angle), -0.8 * np.cos(angle), 0.3 * np.sin(angle / 2)])


def with_toppra(rows: np.ndarray, bounds: np.ndarray) -> float:
    """Duration of the fastest motion from rest to rest by TOPPRA [s]."""
    import toppra
    from toppra.algorithm import TOPPRA
    from toppra.constraint import LinearConstraint

    class Carried(LinearConstraint):
        """The constraints of kilter: a u + b x + c = v, F v <= g with F = 1 and g = 0."""

        def compute_constraint_params(
            self, path: object, gridpoints: np.ndarray
        ) -> tuple[np.ndarray | None, ...]:
            count, number, _ = rows.shape
            unit = np.tile(np.eye(number), (count, 1, 1))
            none = np.zeros((count, number))
            return rows[..., 0], rows[..., 1], -bounds, unit, none, None, None

    toppra.setup_logging("ERROR")
    path = toppra.SplineInterpolator(SAMPLES, curve())
    planner = TOPPRA([Carried()], path, gridpoints=SAMPLES)
    return float(planner.compute_trajectory(0.0, 0.0).duration)


def with_drake(rows: np.ndarray, bounds: np.ndarray) -> float:
    """Duration of the motion with the largest sum of x from rest to rest, by Drake [s]."""
    from pydrake.solvers import MathematicalProgram, Solve

    program = MathematicalProgram()
    x = program.NewContinuousVariables(len(SAMPLES), "x")
    program.AddBoundingBoxConstraint(0.0, np.inf, x)
    program.AddBoundingBoxConstraint(0.0, 0.0, x[[0, -1]])
    step = np.diff(SAMPLES)
    for i, length in enumerate(step):
        # u = (x[i + 1] - x[i]) / (2 length) from sample i to the next one
        over = np.column_stack([-np.ones(len(rows[i])), np.ones(len(rows[i]))]) / (2 * length)
        matrix = rows[i, :, :1] * over
        matrix[:, 0] += rows[i, :, 1]
        least = np.full(len(matrix), -np.inf)
        program.AddLinearConstraint(matrix, least, bounds[i], x[[i, i + 1]])
    program.AddLinearCost(-np.ones(len(SAMPLES)), 0.0, x)
    squared = np.maximum(Solve(program).GetSolution(x), 0.0)
    speed = np.sqrt(squared)
    return float((2 * step / (speed[:-1] + speed[1:])).sum())


def main() -> None:
    """Print the duration that each installed planner finds."""
    path: CarrierPath = path_from_poses(SAMPLES, curve())
    answer = kilter.transport(tray(), path=path)
    assert answer.speed is not None
    print(f"at constant speed s': {1 / answer.speed.factor:.3f} s, without starting and stopping")
    for side, inner in (("carried by proof", True), ("bound of any motion", False)):
        rows, bounds = answer.rows(inner=inner)
        for package, plan in (("toppra", with_toppra), ("pydrake", with_drake)):
            if importlib.util.find_spec(package) is None:
                print(f"{package} is not installed")
            else:
                print(f"{package}: {plan(rows, bounds):.4f} s, {side}")


if __name__ == "__main__":
    main()
