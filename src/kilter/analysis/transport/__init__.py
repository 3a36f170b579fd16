"""Accelerations of a carrier (truck, robot) under which an assembly stays in place."""
