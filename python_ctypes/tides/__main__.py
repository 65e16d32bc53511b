"""The command line tool of this package: `tides` where pip puts it, or python -m tides."""

import os
import sys

from ._tool import tool_beside


def main() -> None:
    tool = tool_beside()
    if tool is None:
        sys.exit("tides: the tool isn't beside the library that this package loads: run make")
    os.execv(tool, ["tides", *sys.argv[1:]])


if __name__ == "__main__":
    main()
