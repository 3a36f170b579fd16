"""Solvers of linear, conic and quadratic programs; callers verify the answers."""
