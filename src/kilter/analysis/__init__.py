"""Analyses of assemblies: verdicts, margins, regions, plans, and the verification of proofs."""
