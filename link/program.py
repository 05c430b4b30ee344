"""Entry point of `mavhelm`: its first word chooses the program, which is imported alone.

So `mavhelm vehicle` starts as fast as `vehicle`. The programs are named, not imported: this package knows neither end.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module

PROGRAMS = {
    "vehicle": "vehicle.__main__",
    "bridge": "link.bridge.__main__",
}
"""First word -> module with the `main` of a program. Everything else is for the ground station."""
GROUND_STATION = "groundstation.__main__"


def main(argv: Sequence[str] | None = None) -> int:
    """Run the program that the first word names with the other words; return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    module = PROGRAMS.get(words[0]) if words else None
    program = import_module(module or GROUND_STATION)
    code: int = program.main(words[1:] if module else words)
    return code


if __name__ == "__main__":
    sys.exit(main())
