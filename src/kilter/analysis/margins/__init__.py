"""Margins of an assembly: the tilt, friction, loads and pushes up to which it holds."""
