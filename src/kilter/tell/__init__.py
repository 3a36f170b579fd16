"""Answers in words: one place for what the terminal, the page and a notebook say."""
