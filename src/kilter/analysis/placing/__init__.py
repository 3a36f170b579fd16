"""Placing: packing plans item by item, and the places at which the next part stands."""
