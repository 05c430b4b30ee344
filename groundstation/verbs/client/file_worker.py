"""FileWorker: reads and writes the files of the user for a verb that a station runs.

The work is done in a thread: a pipe without a writer or a slow disk must not keep this process from Ctrl-C, nor from
telling the station ten times a second that it runs. Only a verb with files imports what does the work.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable

from groundstation.station_socket.verb_run import PIECE, FileAnswered, FileAsked


class FileWorker:
    """Works on one file at a time; `send` takes the answers."""

    def __init__(self, send: Callable[[FileAnswered], None]) -> None:
        self._send = send
        self._number = 0
        self._data = bytearray()
        """What has come to be written, or is left of what was read."""

    def work(self, asked: FileAsked) -> None:
        """Begin what the station asks for, or take the next piece of a file."""
        if asked.number != self._number:
            self._number = asked.number
            self._data.clear()
        if not asked.work:
            self._send_piece(asked.number)
            return
        self._data += asked.data
        if not asked.whole:
            self._send(FileAnswered(asked.number))
            return
        data = bytes(self._data)
        self._data.clear()
        loop = asyncio.get_running_loop()
        threading.Thread(target=self._do, args=(asked, data, loop), daemon=True).start()

    def _do(self, asked: FileAsked, data: bytes, loop: asyncio.AbstractEventLoop) -> None:
        """Do the work, in the thread. The loop may have ended meanwhile."""
        from groundstation.verbs.common.exit_codes import VerbError
        from groundstation.verbs.common.files import FileWork, work_on

        read, error = b"", ""
        try:
            read = work_on(FileWork(asked.work), asked.path, data, asked.overwrite)
        except (VerbError, ValueError) as problem:
            error = str(problem)
        if not loop.is_closed():
            loop.call_soon_threadsafe(self._end, asked.number, read, error)

    def _end(self, number: int, read: bytes, error: str) -> None:
        if number != self._number:
            return
        if error:
            self._send(FileAnswered(number, error=error))
            return
        self._data += read
        self._send_piece(number)

    def _send_piece(self, number: int) -> None:
        piece = bytes(self._data[:PIECE])
        del self._data[:PIECE]
        self._send(FileAnswered(number, piece, whole=not self._data))
