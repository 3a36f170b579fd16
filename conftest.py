"""The option `--for FILE`, and compiled tests in the cache of pytest.

`tests/conftest.py` cannot add the option, since pytest reads FILE before.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from near_tests import near_tests

if sys.dont_write_bytecode:  # without compiled tests the collection takes twice as long
    sys.pycache_prefix = str(Path(__file__).parent / ".pytest_cache/compiled")
    sys.dont_write_bytecode = False


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--for FILE`: see `tests/near_tests.py`."""
    parser.addoption("--for", dest="source", type=Path, metavar="FILE", help="tests of a file")


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Run the tests of `--for`, and the examples of the file itself, in one process."""
    source = config.getoption("source")
    if source is not None:
        if not source.is_file() or not (tests := near_tests(source)):
            raise pytest.UsageError(f"--for {source}: there is no such file with tests")
        config.args = [str(source), *map(str, tests)]
        config.option.numprocesses = 0
