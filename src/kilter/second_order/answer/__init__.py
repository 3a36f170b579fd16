"""Second-order answer for an assembly: minimum, free, balanced or open, with its evidence.

- `whole`: the answer for an assembly, joined from its clusters
- `one_cluster`: the answer for a single cluster
- `second_order_answer`: the answer with its evidence
- `second_order_file`: its proof as data of a proof file
- `oscillation`: the rates of oscillation and of growth
- `path_places`: exact places along the fall of a balanced assembly
"""
