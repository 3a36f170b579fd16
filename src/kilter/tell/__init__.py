"""Answers in words: the sentences, facts and tables of the terminal, of pages and of notebooks."""
