"""``python -m kilter``: the same as the command ``kilter``."""

import sys

from kilter.cli import main

sys.exit(main())
