"""Contacts of smoothly curved faces that two meshes cut into different triangles."""
