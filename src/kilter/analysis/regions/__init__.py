"""Directions of gravity for which an assembly stays together, and tipping of a body on a table."""
