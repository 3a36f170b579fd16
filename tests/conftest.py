"""What all tests share: hypothesis without deadlines, since cores are shared."""

from __future__ import annotations

from hypothesis import settings

collect_ignore_glob = ["*conftest.py"]  # no doctests there, and their names are alike

settings.register_profile("kilter", deadline=None, derandomize=True, max_examples=20)
settings.load_profile("kilter")
