"""Second order: how the gaps of a contact close along motions that keep it touching.

- `features`: what touches at a contact point, a face, an edge or a vertex, and how it curves
- `features_of`: the features of the contacts of a program
- `gap_form`: the second derivative of a gap along the motions of both parts
- `second_order_tolerances`: its tolerances
"""
