"""Contacts from geometry: `find_contacts` turns an assembly into a `ContactSet`."""

from kilter.contact.contact_set import ContactSet, Tolerance
from kilter.contact.detect import find_contacts
from kilter.contact.fits.fastening import fastened

__all__ = ["ContactSet", "Tolerance", "fastened", "find_contacts"]
