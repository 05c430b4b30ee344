"""VehicleKeys: the key file of a running vehicle. It notices changes, and adds keys, in a thread of its own."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from link.key_watch import KeyWatch
from link.signing.key_actions import KeyActionError, store_key
from link.signing.key_file import KeyFileError
from link.signing.keys import KeyRing, SigningKey
from vehicle.storage.store import PendingWrite

log = logging.getLogger(__name__)


class VehicleKeys:
    """A vehicle.commands.signing.KeyStore. Call `poll` in each control cycle."""

    def __init__(self, path: Path) -> None:
        """Read the keys. Raises KeyFileError."""
        self._watch = KeyWatch(path)
        self.listeners: list[Callable[[KeyRing], None]] = []
        """Called with new keys, from `poll`."""

    @property
    def folder(self) -> Path:
        """The state folder that the file is in."""
        return self._watch.path.parent

    @property
    def ring(self) -> KeyRing:
        """The keys of now."""
        return self._watch.ring

    def poll(self, now: float) -> None:
        """Take over what the thread has read. Keys of a file that cannot be read stay in force as they were."""
        try:
            found = self._watch.poll(now)
        except KeyFileError as error:
            log.error("%s; the keys of before stay in force", error)
            return
        if found is not None:
            log.warning("keys changed: %s", ", ".join(map(str, found.keys)) or "none")
            for listener in self.listeners:
                listener(found)

    def add(self, key: SigningKey) -> PendingWrite:
        """Add a key to the file; `poll` then takes it over. Never blocks."""
        pending = PendingWrite()
        if not self._watch.worker.submit(lambda: self._add(key, pending)):
            pending.done, pending.problem = True, "the disk does not answer"
        return pending

    def close(self) -> None:
        """Wait until added keys are written."""
        self._watch.close()

    def _add(self, key: SigningKey, pending: PendingWrite) -> None:
        try:
            store_key(self._watch.path, key)
        except (KeyActionError, KeyFileError) as error:
            log.error("%s", error)
            pending.problem = "see the log of the vehicle"
        self._watch.look()
        pending.done = True
