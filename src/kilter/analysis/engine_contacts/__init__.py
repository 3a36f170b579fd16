"""Verdicts on the contacts of other engines, without geometry."""
