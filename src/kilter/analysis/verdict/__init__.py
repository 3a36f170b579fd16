"""The verdict of `check` and the quantities that follow from it: motion, forces, displacements."""
