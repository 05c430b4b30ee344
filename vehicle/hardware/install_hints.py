"""The hint for a missing library of the extra `pi`."""

from __future__ import annotations

import sys

INSTALL_HINT = f"install it: {sys.executable} -m pip install 'mavhelm[pi]'"
"""Names the running Python: the system's pip refuses on Debian 12 and later, and would install for another Python."""
