"""Convert objects of other libraries to assemblies and back: one module per library."""
