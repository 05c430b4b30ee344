"""Keeps the signing clock right while a program runs, and its memory on the disk: each STORE_PERIOD and at the end."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.runtime.worker import Worker
from link.signing.keys import KeyRing
from link.signing.memory_file import load_memory, save_memory
from link.signing.role import SigningRole
from link.signing.signing import Signing, SigningMemory
from link.signing.system_clock import is_synchronized

log = logging.getLogger(__name__)

STORE_PERIOD = 30.0
"""s between two stores, as in ArduPilot. What was accepted since the last one is not known after a crash."""
NEW_STREAM_PERIOD = 5.0
"""s at least between two stores because of new streams: who holds a key must not wear out the card."""
SIGNED_ONLY = SigningPolicy(unsigned=None)
PATIENCE = 2.0
"""s for the last store; a slower disk is broken."""


class LinkSigning:
    """Owns the signing of one program. `wall` returns Unix time in s."""

    def __init__(
        self,
        ring: KeyRing,
        path: Path | None,
        now: float,
        *,
        policy: SigningPolicy = SIGNED_ONLY,
        wall: Callable[[], float] = time.time,
        synchronized: Callable[[], bool] = is_synchronized,
    ) -> None:
        """Read the memory at `path`; None: nothing is kept. `policy`: of all links. Raises MemoryFileError.

        `synchronized` returns whether the operating system knows the right time.
        """
        self._policy = policy
        self._path = path
        self._wall = wall
        self._synchronized = synchronized
        self._worker = Worker("signing", 2)
        self._store_due = now
        """At once: from now on a crash leaves more than the last run did."""
        self._streams = 0
        self._stored_at = -NEW_STREAM_PERIOD
        self._failed = False
        memory = load_memory(path) if path is not None else None
        self.signing = Signing(ring, wall=wall(), now=now, memory=memory, synchronized=synchronized())

    def guard(self, index: int) -> SigningGuard | None:
        """Return the guard of the link `index`; None while there is no key and nothing unsigned is refused."""
        if not self.signing.ring.keys and self._policy.unsigned is SigningRole.SET_UP:
            return None
        return SigningGuard(self.signing, self._policy, index)

    def update(self, now: float) -> None:
        """Follow the computer's clock, and store what is due. Call it once a second."""
        self.signing.update(self._wall(), now, synchronized=self._synchronized())
        if not self.signing.ring.keys:
            return
        streams = len(self.signing.verifier.streams.newest)
        if now >= self._store_due or (streams != self._streams and now >= self._stored_at + NEW_STREAM_PERIOD):
            self._streams, self._stored_at, self._store_due = streams, now, now + STORE_PERIOD
            self._store(now)

    def close(self, now: float) -> None:
        """Store for the last time."""
        if self.signing.ring.keys:
            self._store(now, ended=True)
        self._worker.close(PATIENCE)

    def _store(self, now: float, *, ended: bool = False) -> None:
        if self._path is not None:
            self._worker.submit(partial(self._write, self._path, self.signing.memory(now, ended=ended)))

    def _write(self, path: Path, memory: SigningMemory) -> None:
        try:
            save_memory(path, memory)
        except OSError as error:
            if not self._failed:
                log.error(
                    "%s: %s; after a restart old signed frames may be accepted again: make room, or correct its folder",
                    path, error.strerror,
                )  # fmt: skip
            self._failed = True
            return
        self._failed = False
