"""Objects of other libraries as assemblies, and assemblies as theirs: one file a library."""
