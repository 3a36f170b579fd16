"""The fewest supports that hold an assembly."""
