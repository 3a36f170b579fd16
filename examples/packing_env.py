"""A Gymnasium environment of palletising whose mask is exact: `kilter.Pile`.

    pip install gymnasium
    python examples/packing_env.py

Each step puts the next box down, unturned or turned by 90 degrees, at a place of a grid. The mask
of actions, `info["action_mask"]`, has the places at which the whole pile stands with the box. The
reward is the volume of the box over that of the bin, and the episode ends when no place is left,
or when a box is put down at a place at which the pile falls. Masks of this form serve
MaskablePPO of sb3-contrib (`action_masks`) and similar methods.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from kilter import Pile

BASE = (1.2, 0.8)
"""Length and width of the pallet [m]."""
HEIGHT = 1.0
"""Largest height of the pile [m]."""
STEP = 0.05
"""Distance of the places [m]."""


class PackingEnv(gymnasium.Env[dict[str, Any], int]):
    """Boxes of random size and mass, one after the other, on a pallet.

    Parameters
    ----------
    mu : float
        Friction coefficient of all contacts [-].
    """

    def __init__(self, mu: float = 0.0) -> None:
        self.mu = mu
        self.shape = 2, round(BASE[0] / STEP), round(BASE[1] / STEP)
        self.action_space = spaces.Discrete(int(np.prod(self.shape)))
        self.observation_space = spaces.Dict(
            {
                # height at which the box would lie at each place; -1 where it would not
                "heights": spaces.Box(-1.0, 10.0, self.shape, np.float64),
                "box": spaces.Box(0.0, 20.0, (4,), np.float64),
            }
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin with an empty pallet."""
        super().reset(seed=seed)
        self.pile = Pile(BASE, self.mu)
        return self._next_box()

    def step(self, action: int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Put the box down at a place."""
        turn, i, j = np.unravel_index(int(action), self.shape)
        if not self.mask[turn, i, j]:
            return self._observation(), -1.0, True, False, self._info()
        size = self.sizes[turn]
        self.pile.add(size, self.mass, (i * STEP, j * STEP))
        observation, info = self._next_box()
        reward = float(size.prod()) / (BASE[0] * BASE[1] * HEIGHT)
        return observation, reward, not self.mask.any(), False, info

    def action_masks(self) -> NDArray[np.bool_]:
        """The mask of actions, as MaskablePPO asks for it."""
        return self.mask.ravel()

    def _next_box(self) -> tuple[dict[str, Any], dict[str, Any]]:
        size = self.np_random.choice([0.15, 0.2, 0.25, 0.3, 0.35, 0.4], 3)
        self.mass = float(self.np_random.uniform(1, 15))
        self.sizes = size, size[[1, 0, 2]]
        fits = [self.pile.fits(turned, self.mass, STEP) for turned in self.sizes]
        self.heights = np.stack([fit.heights for fit in fits])
        low_enough = np.nan_to_num(self.heights, nan=np.inf) + size[2] <= HEIGHT
        self.mask = np.stack([fit.mask for fit in fits]) & low_enough
        return self._observation(), self._info()

    def _observation(self) -> dict[str, Any]:
        return {
            "heights": np.nan_to_num(self.heights, nan=-1.0),
            "box": np.append(self.sizes[0], self.mass),
        }

    def _info(self) -> dict[str, Any]:
        return {"action_mask": self.mask.ravel().astype(np.int8), "boxes": len(self.pile)}


def main() -> None:
    """Pack a pallet by a simple rule: the lowest place of the mask."""
    env = PackingEnv()
    _, info = env.reset(seed=1)
    filled, done = 0.0, False
    while not done:
        heights = np.where(env.mask, env.heights, np.inf)
        _, reward, done, _, info = env.step(int(heights.argmin()))
        filled += reward
    print(f"{info['boxes']} boxes fill {100 * filled:.0f} % of {HEIGHT:g} m: {env.pile.verdict()}")


if __name__ == "__main__":
    main()
