"""Verdicts of many assemblies at once, from objects in memory or from files."""
