"""The command line tool of this package: `tides` where pip puts it, or python -m tides."""

import os
import sys
from pathlib import Path

from ._tool import tool_beside


#: The wheel has a font for pictures, since small systems have none. The system's fonts are preferred.
FONTS = Path(__file__).resolve().parent / "fonts" / "fonts.conf"


def main() -> None:
    tool = tool_beside()
    if tool is None:
        sys.exit("tides: the tool isn't beside the library that this package loads: run make")
    if FONTS.is_file() and not os.environ.get("FONTCONFIG_PATH"):
        os.environ.setdefault("FONTCONFIG_FILE", str(FONTS))
    os.environ.setdefault("TIDES_PYTHON", sys.executable)  # `tides bench live` runs tides.ros2_bench with it
    os.execv(tool, ["tides", *sys.argv[1:]])


if __name__ == "__main__":
    main()
