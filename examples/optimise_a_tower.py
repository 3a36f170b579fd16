"""The gradient of a tilt margin in an optimiser: offsets of a tower, by scipy or by torch.

    python examples/optimise_a_tower.py

The boxes of a tower may move along x. scipy moves them until the tilt margin is largest, at a small
price for each movement. With torch, the margin is a differentiable function of the offsets.
"""

from __future__ import annotations

import importlib.util

import numpy as np
from scipy.optimize import minimize

import kilter

START = np.array([0.1, 0.3, 0.45])
"""Offsets of the boxes at first [m]."""
PRICE = 1.0
"""Price of a movement by a metre [deg]."""


def tower(offsets: np.ndarray) -> kilter.Assembly:
    """Boxes of different widths on a table, each moved along x."""
    parts = [kilter.Part("table", kilter.Box(9, 9, 1), [0, 0, -0.5], grounded=True)]
    for k, x in enumerate(offsets):
        size = [1.2 - 0.1 * k, 2.0, 0.5]
        parts.append(kilter.Part(f"box-{k}", kilter.Box(size), [x, 0, 0.25 + 0.5 * k]))
    return kilter.Assembly(parts, friction=0.9)


def tilt(offsets: np.ndarray) -> tuple[float, np.ndarray]:
    """Tilt margin [deg], and its derivatives by the offsets [deg/m]."""
    answer = kilter.margin(tower(offsets))
    if answer.tilt is None:  # it falls: a line search comes back
        return answer.tilt_deg or 0.0, np.zeros(len(offsets))
    gradient = answer.gradient("tilt")
    return gradient.value, gradient.position[1:, 0].mean(axis=-1)


def cost(offsets: np.ndarray) -> tuple[float, np.ndarray]:
    """Cost of the offsets and its derivatives, for scipy."""
    value, slopes = tilt(offsets)
    moved = offsets - START
    return PRICE * float(moved @ moved) - value, 2 * PRICE * moved - slopes


def by_scipy(steps: int = 12) -> np.ndarray:
    """The offsets after some steps of a quasi-Newton method."""
    limits = [(-0.5, 0.5)] * len(START)
    options = {"maxiter": steps, "maxfun": 4 * steps}
    found = minimize(cost, START, jac=True, method="L-BFGS-B", bounds=limits, options=options)
    return np.asarray(found.x)


def by_torch() -> np.ndarray:
    """The derivatives of the tilt margin by torch, with a function of its own."""
    import torch

    class Tilt(torch.autograd.Function):
        """The tilt margin as a function of torch."""

        @staticmethod
        def forward(context, offsets):
            value, slopes = tilt(offsets.detach().numpy())
            context.save_for_backward(torch.as_tensor(slopes))
            return torch.as_tensor(value)

        @staticmethod
        def backward(context, grown):
            (slopes,) = context.saved_tensors
            return grown * slopes

    offsets = torch.tensor(START, requires_grad=True)
    Tilt.apply(offsets).backward()
    return offsets.grad.numpy()


if __name__ == "__main__":
    print(f"tilt at first {tilt(START)[0]:.3f} deg, derivatives {tilt(START)[1].round(3)}")
    best = by_scipy()
    print(f"tilt by scipy {tilt(best)[0]:.3f} deg, offsets {best.round(4)}")
    if importlib.util.find_spec("torch"):
        print(f"derivatives by torch {by_torch().round(3)}")
