"""Pairs of parts with an uncertain contact (open pairs), and how a verdict depends on them."""
