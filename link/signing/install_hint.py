"""The error for a package of the extra [keys] that is not installed."""

from __future__ import annotations

import sys


class MissingPackageError(Exception):
    """A package is not installed. One line with the command that installs it."""

    def __init__(self, what: str, package: str) -> None:
        install = f"{sys.executable} -m pip install 'mavhelm[keys]'"
        super().__init__(f"{what} the package {package}: {install}; --hex does without")
