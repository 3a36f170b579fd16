"""Robots and scenes of simulators: MJCF and URDF."""
