"""Contacts of smoothly curved faces that two meshes divide into different triangles."""
