"""Shapes of parts in their own frames: primitives, exact solids, surfaces recognised in meshes."""
