"""The nearest pose at rest: candidate points, the programs of a step, the search and its proof."""
