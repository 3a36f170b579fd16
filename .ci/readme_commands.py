"""Print the commands of a README that are marked to be run, one a line."""

import re
import sys
from pathlib import Path

text = Path(sys.argv[1]).read_text(encoding="utf-8")
commands = re.findall(r"<!-- ci: run -->\n```sh\n(.+?)\n```", text, flags=re.S)
if len(commands) != 2:
    sys.exit(f"{sys.argv[1]}: {len(commands)} commands are marked to be run, not 2")
sys.stdout.write("\n".join(commands) + "\n")
