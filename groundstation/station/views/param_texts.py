"""Where the texts of parameters come from, beside the vehicles themselves."""

from __future__ import annotations

from collections.abc import MutableMapping

import msgspec

from groundstation.formats.docs_files import DocsFile


class ParamTexts(msgspec.Struct, frozen=True):
    """Texts that the station's process has read before it starts."""

    files: tuple[DocsFile, ...] = ()
    """Files of the user; the first that fits counts."""
    cache: MutableMapping[int, bytes] = msgspec.field(default_factory=dict)
    """Files that vehicles have served, by the checksum of the general file beside them."""

    @property
    def problems(self) -> tuple[str, ...]:
        """What is wrong with files of the user, a line each."""
        return tuple(file.problem for file in self.files if file.problem)
