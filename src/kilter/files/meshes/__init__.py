"""Files of meshes: OBJ, STL, GLB and 3MF; names, places and accuracy of their bodies."""
