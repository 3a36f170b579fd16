"""Print the commands of a README that are marked to be run, one a line."""

import re
import sys

text = open(sys.argv[1], encoding="utf-8").read()
commands = re.findall(r"<!-- ci: run -->\n```sh\n(.+?)\n```", text, flags=re.S)
if len(commands) != 2:
    sys.exit(f"{sys.argv[1]}: {len(commands)} commands are marked to be run, not 2")
print("\n".join(commands))
