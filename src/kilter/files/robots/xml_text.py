"""Parse the XML of a file; a damaged text is an `InputError`."""

from __future__ import annotations

import re
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
        try:
            return ElementTree.fromstring(data)
        except ElementTree.ParseError:
            return ElementTree.fromstring(_tolerated(data))
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(
            f"the XML is invalid: {error}", file=str(path), hint="correct the file"
        ) from None
    except InputError as error:
        raise error.located(file=str(path)) from None


def _tolerated(data: bytes) -> bytes:
    """XML without faults that simulators tolerate.

    These are spaces before the declaration, comments with two hyphens, and prefixes of names that
    the file does not declare.
    """
    plain = re.sub(rb"<!--.*?-->", b"", data.lstrip(), flags=re.DOTALL)
    declared = {b"xml", b"xmlns", *re.findall(rb"xmlns:(\w+)", plain)}

    def renamed(found: re.Match[bytes]) -> bytes:
        """The start of a tag or an attribute, with a prefix that is not declared in its name."""
        mark, prefix = found.groups()
        return mark + prefix + (b":" if prefix in declared else b"_")

    return re.sub(rb"(</?|\s)([A-Za-z_]\w*):(?=\w+[\s=/>])", renamed, plain)
