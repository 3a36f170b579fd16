"""USD scenes: the objects of a stage as parts, and a layer with new poses; extra ``usd``."""
