"""In which order: states of an assembly that is being built, a question for each file."""
