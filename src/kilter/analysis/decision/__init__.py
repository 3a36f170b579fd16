"""The decision: does an assembly hold, at which level, by which proof."""
