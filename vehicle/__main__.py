"""Runs `python -m vehicle`."""

from __future__ import annotations

import sys

from vehicle.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
