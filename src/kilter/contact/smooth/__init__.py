"""Contacts of smoothly curved faces whose two meshes have different triangles."""
