"""Fits of parts: overlaps, shafts in holes, and fastened pairs."""
