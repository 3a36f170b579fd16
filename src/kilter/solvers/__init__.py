"""Solvers of linear and quadratic programs, one package a file; they judge nothing."""
