"""Second order: how the gaps of a contact close along motions that keep it touching.

- `features`: what touches at a contact point, a face, an edge or a vertex, and how it curves
- `features_of`: the features of the contacts of a program
- `part_features`: the feature of a part at points of its surface
- `gap_form`: the second derivative of a gap along the motions of both parts
- `stationary`: gaps and load to second order, in scaled unknowns
- `critical`: the motions that cost nothing to first order
- `curved_energy`: forces under which the energy curves upward
- `paths`: paths that lead down, judged without a solver
- `path_search`: the search for them
- `minimum_proof`: proofs of a minimum, judged without a solver
- `decide`: minimum, balanced or open
- `recognised`, `every_surface`: what holds for every surface that a mesh may stand for
- `touched_surfaces`, `free_motions`, `free_span`: motions that keep every gap and the energy
- `separation`: parts in other places, held apart exactly
- `parting_planes`, `path_places`: places along which what is balanced falls
- `clusters`: free parts that contacts join
- `level_rest`: what stands on level faces is free by proof, at any size
- `held`: forces that leave no motion neutral
- `rolling`: does friction hold what is balanced, or does it roll off?
- `second_order_answer`: what is said of one cluster
- `whole`: what a check says of all of them
- `second_order_tolerances`: its tolerances
"""
