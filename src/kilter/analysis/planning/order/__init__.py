"""Orders of assembly: their search, their steps, their proofs."""
