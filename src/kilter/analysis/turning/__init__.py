"""Orientations in which an assembly holds, or most nearly holds (Problem 2 of the paper)."""
