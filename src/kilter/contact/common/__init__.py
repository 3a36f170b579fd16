"""Shared by all families of contacts: facets, edges, gaps, patches and the search."""
