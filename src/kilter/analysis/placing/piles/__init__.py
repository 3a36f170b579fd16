"""Piles of boxes as arrays, for packing loops."""
