"""Gap of each contact as a function of the motions of its parts, to second order.

- `features`: the face, edge or vertex of each part at a contact point, and its curvature
- `features_of`: the features at the contacts of a program
- `part_features`: the feature of a part at points of its surface
- `gap_form`: the second derivative of a gap
- `stationary`: gaps and load to second order in scaled unknowns
- `recognised`: gap forms that hold for every surface that a mesh may represent
- `touched_surfaces`: the surfaces in contact, as far as they are known to all orders
"""
