"""The program of an assembly, its linear and conic forms, and the proofs of the answers."""
