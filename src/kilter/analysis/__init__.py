"""Answers about an assembly (verdicts, margins, regions, plans), and checks of their proofs."""
