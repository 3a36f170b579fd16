"""Questions asked of a program, one a file."""
