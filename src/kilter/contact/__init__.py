"""Contacts from geometry: `contacts` turns an assembly into a `ContactSet`."""

from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts
from kilter.contact.fits.fastening import fastened

__all__ = ["ContactSet", "Tolerance", "contacts", "fastened"]
