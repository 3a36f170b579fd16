"""Shapes of parts in their own frames: given, exact, and recognised in a mesh."""
