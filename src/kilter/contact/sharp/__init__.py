"""Contacts at edges and corners."""
