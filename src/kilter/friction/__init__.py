"""Coulomb's contact law: which motions obey it, and whether any does."""
