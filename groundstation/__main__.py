"""Entry point of `python -m groundstation`."""

from __future__ import annotations

import sys

from groundstation.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
