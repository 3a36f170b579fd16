"""Open pairs: the pairs that decide, and the guarantee of friction if they touch."""
