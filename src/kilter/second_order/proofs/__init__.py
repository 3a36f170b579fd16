"""Second-order proofs, and functions that verify them without a solver or a search.

- `held`: forces that leave no motion neutral
- `level_rest`: parts that rest on level faces
- `locked`: faces that slide on faces, with turns locked by self-stress
- `stopped`: level motions that stops limit
- `minimum_proof`: a strict minimum of the energy
- `paths`, `fall_proof`: a path along which parts fall, and an exact place on it
- `carrying`: contacts that carry force beyond rounding
- `modelled`: contacts, joints and loads that second order does not model
- `proof_kinds`: the protocol of these six kinds
- `cluster_facts`: facts of a cluster that judges and searches use
- `proof_numbers`: numbers and motions of a proof file
- `second_order_recheck`: recheck of the proof in a proof file
"""
