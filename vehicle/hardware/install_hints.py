"""What to say where a library of the extra `pi` is missing."""

from __future__ import annotations

import sys

INSTALL_HINT = f"install it: {sys.executable} -m pip install 'mavhelm[pi]'"
"""With the Python that is running: the system's own pip refuses on Debian 12 and later, and would install elsewhere."""
