"""Second order: whether a motion without first-order change of energy lowers the energy.

Folders, each of which uses only those before it:

- `gaps`: the gap of each contact to second order, from the features that touch there
- `parts`: groups of parts, their support by one another, and their exact separation
- `motions`: neutral motions, motions that keep every gap, and rolling with friction
- `proofs`: the six kinds of proof, their judges and their form in a proof file; no solver
- `searches`: the searches for these proofs
- `answer`: the answer for each cluster and for the whole assembly, with its proof file

`second_order_tolerances` has the tolerances of all folders.
"""
