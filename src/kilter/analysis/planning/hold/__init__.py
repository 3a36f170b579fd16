"""Search for the fewest supports that hold an assembly."""
