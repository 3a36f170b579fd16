"""Derivatives of limits by the data of an assembly, and changes that these derivatives select."""
