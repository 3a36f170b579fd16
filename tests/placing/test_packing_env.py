"""The example of a Gymnasium environment runs, and its mask is the answer of the pile."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "packing_env.py"


def example() -> ModuleType:
    pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")
    spec = importlib.util.spec_from_file_location("packing_env", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_environment_keeps_the_rules_of_gymnasium() -> None:
    module = example()
    from gymnasium.utils.env_checker import check_env

    check_env(module.PackingEnv(), skip_render_check=True)


def test_allowed_actions_keep_the_pile_standing() -> None:
    env = example().PackingEnv()
    _, info = env.reset(seed=4)
    rng = np.random.default_rng(4)
    for _ in range(8):
        allowed = np.flatnonzero(info["action_mask"])
        _, reward, ended, _, info = env.step(int(rng.choice(allowed)))
        assert reward > 0
        assert env.pile.stands
        assert ended == (not info["action_mask"].any())
    forbidden = int(np.flatnonzero(info["action_mask"] == 0)[0])
    _, reward, ended, _, _ = env.step(forbidden)
    assert (reward, ended, len(env.pile)) == (-1.0, True, 8)
