"""Contacts of curved faces."""
