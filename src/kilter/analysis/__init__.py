"""Analyses of an assembly, a file for each question."""
