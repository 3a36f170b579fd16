"""The ladder of assumptions about an inexact file: drawn, play, fits, joined."""
