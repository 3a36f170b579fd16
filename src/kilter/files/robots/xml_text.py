"""Parse the XML of a file; a damaged text is an `InputError`."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from kilter.errors import InputError
from kilter.files.limits import read_bytes, require_few_entries


def xml_root(path: Path) -> ElementTree.Element:
    """Root element of an XML file.

    Raises `InputError` if the file cannot be read or is no XML; the error names the file.
    """
    data = read_bytes(path)
    try:
        require_few_entries(data)
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(
            f"the XML is invalid: {error}", file=str(path), hint="correct the file"
        ) from None
    except InputError as error:
        raise error.located(file=str(path)) from None
