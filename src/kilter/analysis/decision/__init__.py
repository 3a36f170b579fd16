"""Decide whether an assembly holds, at which level, and by which proof."""
