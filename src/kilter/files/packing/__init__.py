"""Packing plans, and sequences in tables."""
