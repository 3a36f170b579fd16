"""In which order: states of an assembly that is being built, one question a file."""
