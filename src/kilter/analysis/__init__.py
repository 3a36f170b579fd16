"""Verdicts, margins, regions, plans, and the verification of proofs."""
