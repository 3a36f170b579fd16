"""Values that are compared by content, and the names that users guess for their attributes."""
