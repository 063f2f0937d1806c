"""``python -m mutabot``: the command line."""

from __future__ import annotations

import sys

from mutabot.cli.app import main

if __name__ == "__main__":
    sys.exit(main())
