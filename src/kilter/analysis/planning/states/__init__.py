"""States of a half-built assembly: the parts present, the parts held, and whether they stand."""
