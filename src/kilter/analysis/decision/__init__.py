"""Decide whether an assembly stays together, how strong the statement is, and by which proof."""
