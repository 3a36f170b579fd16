"""Search for orders of assembly, their steps, and their proofs."""
