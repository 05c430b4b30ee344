"""The session that a verb leaves to the next one, in a file of the user, so that `arm && mission start` is one driver.

Our vehicle gives control to a session, a random number, and obeys it while it is proven (docs/safety.md, "Who the
driver is"). A verb that begins soon after another one with the same system id goes on with its session. Only one verb
at a time uses it: the file is locked meanwhile, and a second one gets a session of its own. A verb that only watches
proves the session while no other verb does, so that the vehicle does not miss its ground station.

No fault of the file keeps a verb from its work: it has a new session then.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from pathlib import Path
from typing import TYPE_CHECKING

from groundstation.station.component import COMPONENT
from groundstation.station_socket.verb_run import KEEP
from groundstation.verbs.session.core import WATCHER

if TYPE_CHECKING:
    from groundstation.verbs.action import VerbAction

MAX_SIZE = 64


def default_folder() -> Path:
    """Return the user's state folder."""
    from platformdirs import user_state_path  # a verb through a station does without

    return user_state_path("mavhelm")


class KeptSession:
    """The session of a verb. Times are of the monotonic clock, which all programs of a computer share."""

    def __init__(self, number: int, file: int | None = None, *, follows: bool = False) -> None:
        self.number = number
        self._file = file
        """Descriptor of the file; None: the session ends with this verb."""
        self.follows = follows
        """The session is that of the verb before, which is only proven here."""

    @classmethod
    def take(cls, system: int, now: float, folder: Path | None = None) -> KeptSession:
        """Return the session of the verb before with this system id, or a new one, and keep others from it."""
        file = _open(system, folder, create=True)
        if file is None or not _lock(file):
            _close(file)
            return cls(_new_number())
        number = _read(file, now)
        kept = cls(_new_number() if number is None else number, file)
        kept._write(now)
        return kept

    @classmethod
    def follow(cls, system: int, now: float, folder: Path | None = None) -> KeptSession | None:
        """Return the session of the verb before, to prove it while no other verb does; None: there was none."""
        file = _open(system, folder, create=False)
        number = None if file is None else _read(file, now)
        if number is None:
            _close(file)
            return None
        return cls(number, file, follows=True)

    def may_prove(self, now: float) -> bool:
        """Return whether a verb that follows may prove the session now: no verb has it or has made another one."""
        if self._file is None or not _lock(self._file):
            return False
        mine = _read(self._file, now) == self.number
        if mine:
            self._write(now)
        _unlock(self._file)
        return mine

    def end(self, now: float) -> None:
        """Leave the session to the next verb, which may begin until KEEP s after `now`."""
        if self._file is not None:
            if not self.follows:
                self._write(now)
            _unlock(self._file)
            _close(self._file)
            self._file = None

    def _write(self, now: float) -> None:
        assert self._file is not None
        with contextlib.suppress(OSError):
            os.ftruncate(self._file, 0)
            os.pwrite(self._file, f"{self.number} {now:.3f}\n".encode(), 0)


def choose_identity(action: VerbAction, system: int, now: float) -> tuple[tuple[int, int], KeptSession]:
    """Return our ids, and our session: that of the verb before if this one takes part or follows, else a new one."""
    if action.needs_session:
        kept = KeptSession.take(system, now)
    else:
        kept = (KeptSession.follow(system, now) if action.follows else None) or KeptSession(_new_number())
    looks = action.watches and not action.examines and not kept.follows
    return (system, WATCHER if looks else COMPONENT), kept


def _new_number() -> int:
    return int.from_bytes(os.urandom(4))


def _open(system: int, folder: Path | None, *, create: bool) -> int | None:
    path = (folder or default_folder()) / f"session-{system}"
    flags = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK
    try:
        if create:
            path.parent.mkdir(parents=True, exist_ok=True)
        return os.open(path, flags | (os.O_CREAT if create else 0), 0o600)
    except OSError:
        return None


def _close(file: int | None) -> None:
    if file is not None:
        os.close(file)


def _lock(file: int) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _unlock(file: int) -> None:
    with contextlib.suppress(OSError):
        fcntl.flock(file, fcntl.LOCK_UN)  # also for the watchdog, which has inherited the descriptor


def _read(file: int, now: float) -> int | None:
    """Return the session in the file; None if there is none, or none of the last KEEP s."""
    try:
        number, _, used = os.pread(file, MAX_SIZE, 0).decode("ascii").partition(" ")
        return int(number) if 0 <= now - float(used) <= KEEP and 0 <= int(number) < 1 << 32 else None
    except (OSError, ValueError):
        return None
