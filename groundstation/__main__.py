"""Entry point of `python -m groundstation`."""

from __future__ import annotations

import signal
import sys

# Until the screen handles Ctrl-C, it ends the program without a word; Python would print where its imports are.
signal.signal(signal.SIGINT, signal.SIG_DFL)

from groundstation.cli.main import main  # noqa: E402

if __name__ == "__main__":
    sys.exit(main())
