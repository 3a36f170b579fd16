"""Plans of assembly: the order of the steps, parts to hold at each step, and fixtures."""
