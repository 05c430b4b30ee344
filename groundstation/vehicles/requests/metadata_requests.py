"""The texts of a vehicle's parameters that it serves itself: COMPONENT_METADATA, then two files by MAVLink FTP.

Source: https://mavlink.io/en/services/component_information.html.
"""

from __future__ import annotations

import re
from collections.abc import Callable, MutableMapping

from groundstation.formats.errors import FileFormatError
from groundstation.formats.metadata_json import parse_general, parse_parameters
from groundstation.formats.param_docs import ParamDocs
from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.state.identity import VehicleIdentity
from link.services.ftp.job import FtpOutcome

SOURCE = "the vehicle"
_URI = re.compile(r"mftp://(?:\[;comp=\d+\])?(/?.+)")


class MetadataRequests:
    """Downloads the texts once they are wanted. `cache` keeps files by the checksum of the general file."""

    def __init__(self, files: FileRequests, identity: VehicleIdentity, cache: MutableMapping[int, bytes]) -> None:
        self._files = files
        self._identity = identity
        self._cache = cache
        self.docs = ParamDocs()
        self.problem = ""
        """Why there are no texts, one line."""
        self._begun: int | None = None
        """Checksum of the general file that the texts are from."""

    def want(self) -> None:
        """Request the texts, unless they are known or the vehicle has no files."""
        if self._identity.settled and self._identity.may_have_files:
            self._identity.want_metadata()

    def tick(self, now: float) -> None:
        """Begin when the vehicle has said where its files are."""
        found = self._identity.metadata
        if found is None or found.file_crc == self._begun:
            return
        self._begun = found.file_crc
        if found.file_crc in self._cache:
            self._take_parameters(self._cache[found.file_crc])
        elif found.uri:
            self._download(found.uri, self._take_general, now)

    def _download(self, uri: str, take: Callable[[bytes, float], None], now: float) -> None:
        path = _URI.fullmatch(uri)
        if path is None:
            self.problem = f"texts of the vehicle: {uri!r} is not on the vehicle"
            return

        def handle(outcome: FtpOutcome, later: float) -> None:
            if outcome.done:
                take(outcome.data, later)
            else:
                self.problem = f"texts of the vehicle: {path[1]}: {outcome.problem}"

        self._files.start_download(path[1], handle, now)

    def _take_general(self, data: bytes, now: float) -> None:
        try:
            uri = parse_general(data, f"{SOURCE}'s general metadata")
        except FileFormatError as error:
            self.problem = str(error)
            return
        if uri:
            self._download(uri, self._take_new_parameters, now)

    def _take_new_parameters(self, data: bytes, now: float) -> None:
        if self._take_parameters(data) and self._begun:
            self._cache[self._begun] = data

    def _take_parameters(self, data: bytes) -> bool:
        try:
            self.docs = ParamDocs(SOURCE, parse_parameters(data, f"{SOURCE}'s parameter metadata").docs)
        except FileFormatError as error:
            self.problem = str(error)
            return False
        self.problem = ""
        return True
