"""Solvers of linear, conic and quadratic programs; their answers are not verified here."""
