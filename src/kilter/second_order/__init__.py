"""Second order: how the gaps of a contact close along motions that keep it touching.

features         what touches at a contact point: face, edge or vertex, and how it curves
gap_form         the second derivative of a gap along the motions of both parts

second_order_tolerances
"""
