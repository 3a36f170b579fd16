"""Transport: the accelerations of a carrier under which an assembly stays in place."""
