"""By how much it stays: tilt, friction, loads and pushes."""
