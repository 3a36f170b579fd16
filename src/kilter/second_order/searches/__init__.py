"""Searches for second-order proofs, by linear, conic and semidefinite programs.

- `critical`: motions that cost nothing to first order
- `curved_energy`: forces under which the energy curves upward
- `decide`: minimum, balanced or open
- `held_search`, `level_rest_search`, `locking_stress`, `stopping_weights`: a kind of proof each
- `path_search`, `parted_path`: paths that lead down
- `opening_contacts`: motions that open contacts
- `every_surface`: proofs for every surface that a mesh may represent
"""
