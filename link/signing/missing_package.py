"""The error for a package of the extra [keys] that is not installed."""

from __future__ import annotations

from link.runtime.install_hint import install_command


class MissingPackageError(Exception):
    """A package is not installed. One line with the command that installs it."""

    def __init__(self, what: str, package: str) -> None:
        super().__init__(f"{what} the package {package}: {install_command('keys')}; --hex does without")
