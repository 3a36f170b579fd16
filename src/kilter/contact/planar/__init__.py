"""Contacts of flat faces."""
