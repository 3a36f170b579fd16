"""Every direction of gravity for which an assembly stays."""
