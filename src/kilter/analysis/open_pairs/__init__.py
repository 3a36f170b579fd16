"""Open pairs: which of them decide, and what friction guarantees if they touch."""
