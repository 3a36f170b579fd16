"""How parts fit into each other: overlaps, shafts in holes, what is fastened."""
