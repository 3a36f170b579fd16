"""Solvers of linear, conic and quadratic programs; they do not verify their answers."""
