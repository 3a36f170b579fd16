"""Which way up it stays, or most nearly stays."""
