"""`mavhelm messages` and `watch`: which messages arrive, and the values in one of them."""

from __future__ import annotations

import argparse
import asyncio
import fnmatch
from collections.abc import Sequence
from datetime import UTC, datetime

import msgspec

from dialects.codec import CRC_SIZE, HEADER_V2, EncodeError, encode_payload
from dialects.messages import Message, field_value
from groundstation.formats.csv_row import csv_row
from groundstation.natural_order import natural_key
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.common.tables import format_table
from groundstation.verbs.messages.message_values import (
    Condition,
    FieldPath,
    find_field,
    find_message,
    parse_condition,
    value_text,
)
from groundstation.verbs.session.session import VerbSession
from link.core import Received

QUIET_AFTER = 2.0
"""s without the message before `watch` says so."""


class _Count(msgspec.Struct):
    count: int = 0
    bytes: int = 0


async def messages(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print the kinds of messages that arrive, with their rates."""
    counts: dict[tuple[int, int, str], _Count] = {}

    def tap(received: Received, now: float) -> None:
        name = type(received.message).msgname
        if not options.patterns or any(fnmatch.fnmatchcase(name, each.upper()) for each in options.patterns):
            count = counts.setdefault((received.system, received.component, name), _Count())
            count.count += 1
            count.bytes += _length(received.message)

    session.core.taps.append(tap)
    began = session.now
    await asyncio.sleep(options.seconds)
    over = session.now - began
    rows = sorted(counts.items(), key=lambda each: (*each[0][:2], natural_key(each[0][2])))
    cells = [
        (f"{system}/{component}", name, str(each.count), f"{each.count / over:.1f}", f"{each.bytes / over:.0f}")
        for (system, component, name), each in rows
    ]
    for line in format_table(("source", "message", "count", "Hz", "B/s"), cells):
        output.line(line)
    for (system, component, name), each in rows:
        output.record(
            system=system, component=component, name=name, count=each.count,
            rate=round(each.count / over, 3), bytes_per_second=round(each.bytes / over, 1),
        )  # fmt: skip
    if options.patterns and not rows:
        raise VerbError(ExitCode.DIFFERS, f"no message matches {' or '.join(options.patterns)}")
    return ExitCode.DONE


def check_watch(options: argparse.Namespace) -> None:
    """Read what to watch and until when. Raises VerbError."""
    name, _, path = options.what.partition(".")
    kind = find_message(name)
    chosen = find_field(kind, path) if path else None
    options.kind, options.field = kind, chosen
    options.condition = parse_condition(options.until, kind, chosen) if options.until else None
    if options.csv and options.json:
        raise VerbError(ExitCode.USAGE, "--csv or --json, not both")


async def watch(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print each message of a kind, until a condition holds or the time is over."""
    watcher = _Watcher(session, options, output)
    ended = asyncio.ensure_future(session.core.add_waiter(lambda: watcher.reached))
    session.core.taps.append(watcher.handle)
    try:
        await asyncio.wait({ended, watcher.broken}, timeout=options.timeout, return_when=asyncio.FIRST_COMPLETED)
    finally:
        ended.cancel()
        watcher.close()
    if watcher.broken.done():
        watcher.broken.result()  # the output is closed
    if options.condition is None or watcher.reached:
        return ExitCode.DONE
    last = f"; the last was {watcher.newest}" if watcher.newest else "; none arrived"
    raise VerbError(ExitCode.DIFFERS, f"{options.what} {options.until}: not so within {options.timeout:g} s{last}")


class _Watcher:
    """Prints the messages of one kind of the vehicle."""

    def __init__(self, session: VerbSession, options: argparse.Namespace, output: Output) -> None:
        self._kind: type[Message] = options.kind
        self._path: FieldPath | None = options.field
        self._condition: Condition | None = options.condition
        self._system = session.vehicle.system
        self._csv: bool = options.csv
        self._output = output
        self.reached = False
        self.newest = ""
        self.broken: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._hint = asyncio.get_running_loop().call_later(QUIET_AFTER, self._say_quiet)
        if self._csv:
            self._write_csv(["time", *(str(path) for path in self._paths())])

    def close(self) -> None:
        """Print nothing more."""
        self._hint.cancel()

    def handle(self, received: Received, now: float) -> None:
        """Print a message, and see whether it is the last one."""
        message = received.message
        if type(message) is not self._kind or received.system != self._system or self.reached or self.broken.done():
            return
        self._hint.cancel()
        try:
            self._print(message)
        except OSError as error:
            self.broken.set_exception(error)
        self.reached = self._condition is not None and self._condition.holds(message)

    def _print(self, message: Message) -> None:
        clock = datetime.now(UTC)
        values = {str(path): path.read(message) for path in self._paths()}
        shown = self._condition.field if self._condition and self._path is None else self._path
        self.newest = value_text(shown.read(message)) if shown else ""
        stamp = clock.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        if self._csv:
            self._write_csv([stamp, *(value_text(value) for value in values.values())])
        elif self._path is not None:
            self._output.line(value_text(values[str(self._path)]))
        else:
            words = " ".join(f"{name}={value_text(value)}" for name, value in values.items())
            self._output.line(f"{clock:%H:%M:%S}.{clock.microsecond // 1000:03}Z {words}")
        self._output.record(time=stamp, vehicle=self._system, name=self._kind.msgname, fields=values)
        self._output.flush()

    def _paths(self) -> Sequence[FieldPath]:
        return [self._path] if self._path is not None else [FieldPath(name) for name in self._kind.fieldnames]

    def _write_csv(self, cells: Sequence[str]) -> None:
        self._output.line(csv_row(cells))

    def _say_quiet(self) -> None:
        name = self._kind.msgname
        self._output.note(f"no {name} arrives; `mavhelm rate {name} 2` requests it, where the vehicle has it")


def print_message(message: Message, output: Output) -> None:
    """Print all fields of one message."""
    values = {name: field_value(message, name) for name in type(message).fieldnames}
    width = max(map(len, values), default=0)
    for name, value in values.items():
        unit = type(message).fieldunits_by_name.get(name, "")
        output.line(f"{name:<{width}}  {value_text(value)} {unit}".rstrip())
    output.record(name=type(message).msgname, fields=values)


def _length(message: Message) -> int:
    """Return the bytes of the frame, as MAVLink 2 without a signature."""
    try:
        return HEADER_V2 + len(encode_payload(message)) + CRC_SIZE
    except EncodeError:
        return HEADER_V2 + CRC_SIZE
