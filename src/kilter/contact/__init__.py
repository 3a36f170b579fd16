"""Contacts from geometry: `find_contacts` turns an assembly into a `ContactSet`."""

from kilter.contact.contact_set import ContactSet, Tolerance
from kilter.contact.detect import find_contacts

__all__ = ["ContactSet", "Tolerance", "find_contacts"]
