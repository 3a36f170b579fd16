"""The program of an assembly, the forms it is solved in, and the proofs of its answers."""
