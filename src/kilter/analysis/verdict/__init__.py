"""The verdict of `check`, and the motion, forces and displacements that belong to it."""
