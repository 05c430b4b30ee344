"""Frames found, decoded and encoded a second, against pymavlink: same definitions, same bytes, same run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from lzma import LZMAError
from pathlib import Path
from typing import Any

from dialects import codec, rover
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from link.protocol.channel import Channel
from link.protocol.framer import Framer
from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.plain_pymavlink import plain_module
from tests.benchmarks.rates import Work, rates
from tests.benchmarks.traffic import chopped, framed, joined, mix, telemetry_log

FRAMES = 20_000
SERIAL_READ = 64
"""Bytes that a read of a serial port returns, about; frames are cut anywhere."""

DRIVE_SCREEN = frozenset(
    message.id
    for message in (
        *(m.Heartbeat, m.ControlStatus, m.RoverDriveStatus, m.RoverFailsafeStatus, m.RoverDriveInfo, m.Attitude),
        *(m.VfrHud, m.LocalPositionNed, m.GlobalPositionInt, m.HomePosition, m.GpsRawInt, m.SysStatus),
        *(m.BatteryStatus, m.ServoOutputRaw, m.StatusText, m.CommandAck, m.Timesync),
    )
)
"""What the Drive screen reads (groundstation/vehicles/state/vehicle_state.py, groundstation/station/station.py)."""

PYMAVLINK = "pymavlink parse_buffer"
FRAMER = "framer"
SCREEN = "framer + screen's"
ALL = "framer + all"
CHANNEL = "channel + screen's"


def run(options: Options) -> Report:
    """Measure the framer and the codec."""
    report = Report()
    for name, frames in _sources(options).items():
        _receiving(report, name, frames, options)
    _sending(report, options)
    _noise(report)
    return report


def _sources(options: Options) -> dict[str, list[bytes]]:
    count = FRAMES // 10 if options.quick else FRAMES
    sources = {"mix of 7 kinds": mix(count)}
    if options.tlog is not None:
        try:
            sources["ardurover.tlog"] = telemetry_log(Path(options.tlog), count)
        except (OSError, LZMAError) as error:
            raise BenchmarkError(f"telemetry log {options.tlog}: {error}") from error
    return sources


# ---- receiving ----

NOTE = """`x`: against pymavlink in the same row. `+ screen's`: and decode the messages that the Drive screen reads.
`+ all`: and decode everything. `channel`: with sequence, peers and rate limits, as the programs run it."""


DATAGRAM_GOALS = (("framer", FRAMER, 13.0), ("framer + Drive screen", SCREEN, 7.0))
STREAM_GOALS = (("framer", FRAMER, 8.0), ("framer + Drive screen", SCREEN, 5.0))
"""What, its column, and how many times as fast as pymavlink it is to be."""


def _receiving(report: Report, source: str, frames: Sequence[bytes], options: Options) -> None:
    forms = {
        "a frame a datagram": (list(frames), False),
        "8 frames a datagram": (joined(frames, 8), False),
        f"stream, {SERIAL_READ} bytes a read": (chopped(frames, SERIAL_READ), True),
    }
    table = Table(f"Receiving, {source}: frames a second", note=NOTE)
    for form, (pieces, stream) in forms.items():
        options.say(f"framer: {source}, {form}")
        measured = rates(_receivers(pieces, stream=stream), len(frames), quick=options.quick)
        table.rows.append(_against({"input": form}, measured, PYMAVLINK))
        if stream or len(pieces) == len(frames):
            for what, ours, limit in STREAM_GOALS if stream else DATAGRAM_GOALS:
                report.goals.append(_ratio(f"{what}, {source}, {form}", measured, ours, limit))
    report.tables.append(table)


def _against(row: Row, measured: Mapping[str, float], reference: str) -> Row:
    row[reference] = measured[reference]
    for name, rate in measured.items():
        if name != reference:
            row[name] = rate
            row[f"x {name}"] = rate / measured[reference]
    return row


def _ratio(what: str, measured: Mapping[str, float], ours: str, limit: float) -> Goal:
    theirs = measured[PYMAVLINK]
    return Goal(what, measured[ours] / theirs, limit, "x", True, f"{PYMAVLINK}, {brief(theirs)} frames/s")


def _receivers(pieces: Sequence[bytes], *, stream: bool) -> dict[str, Work]:
    return {
        PYMAVLINK: partial(_pymavlink, pieces),
        FRAMER: partial(_framer, pieces, stream),
        SCREEN: partial(_decoding, pieces, stream, DRIVE_SCREEN),
        ALL: partial(_decoding, pieces, stream, frozenset(rover.mavlink_map)),
        CHANNEL: partial(_channel, pieces, stream, DRIVE_SCREEN),
    }


def _parser() -> Any:
    """pymavlink's parser as mavutil configures it: bad bytes are dropped and counted, not raised."""
    parser = plain_module().MAVLink(None)
    parser.robust_parsing = True
    return parser


def _pymavlink(pieces: Sequence[bytes]) -> None:
    parse = _parser().parse_buffer
    for piece in pieces:
        parse(piece)


def _framer(pieces: Sequence[bytes], stream: bool) -> None:
    feed = Framer(stream=stream).feed
    for piece in pieces:
        feed(piece, 0.0)


def _decoding(pieces: Sequence[bytes], stream: bool, ids: frozenset[int]) -> None:
    feed, decode_frame = Framer(stream=stream).feed, codec.decode_frame
    for piece in pieces:
        for message_id, _, _, _, raw in feed(piece, 0.0):
            if message_id in ids:
                decode_frame(message_id, raw)


def _channel(pieces: Sequence[bytes], stream: bool, ids: frozenset[int]) -> None:
    receive = Channel("bench", 0, system=255, component=190, stream=stream, wanted=ids).receive
    for place, piece in enumerate(pieces):
        receive(piece, "peer", place * 0.01)  # 100 datagrams a second, below the rate limits


# ---- sending ----


MADE = "made message to bytes"
NUMBERS_GOAL, MADE_GOAL = 5.0, 8.0
"""Times as fast as pymavlink."""


def _sending(report: Report, options: Options) -> None:
    options.say("framer: encoding")
    table = Table("Sending MANUAL_CONTROL: frames a second")
    for task, encoders in _encoders().items():
        measured = rates(encoders, 1000, quick=options.quick)
        ratio = measured["ours"] / measured["pymavlink"]
        table.rows.append({"task": task, **measured, "x": ratio})
        limit = MADE_GOAL if task == MADE else NUMBERS_GOAL
        beside = f"pymavlink, {brief(measured['pymavlink'])} frames/s"
        report.goals.append(Goal(f"MANUAL_CONTROL, {task}", ratio, limit, "x", True, beside))
    report.tables.append(table)


def _encoders() -> dict[str, dict[str, Work]]:
    plain = plain_module()
    mavlink, theirs = plain.MAVLink(None, srcSystem=255, srcComponent=190), plain.MAVLink_manual_control_message
    axes = Axes(0.6, -0.2)
    numbers = (1, 600, 32767, 32767, -200, 0)
    made, their_made = build_manual_control(axes, 1), theirs(*numbers)
    return {
        "axes to bytes": {
            "pymavlink": _times(lambda: theirs(*numbers).pack(mavlink)),
            "ours": _times(lambda: framed(build_manual_control(axes, 1), 7, 255, 190)),
        },
        "numbers to bytes": {
            "pymavlink": _times(lambda: theirs(*numbers).pack(mavlink)),
            "ours": _times(lambda: framed(m.ManualControl(*numbers), 7, 255, 190)),
        },
        MADE: {
            "pymavlink": _times(lambda: their_made.pack(mavlink)),
            "ours": _times(lambda: framed(made, 7, 255, 190)),
        },
    }


def _times(encode: Callable[[], object]) -> Work:
    def work() -> None:
        for _ in range(1000):
            encode()

    return work


# ---- noise ----


def _noise(report: Report) -> None:
    """Return 40 frames of a 20 Hz stream with one stray start byte before the first."""
    frames = [framed(build_manual_control(Axes(0.5, 0.1), 1), each, 255, 190) for each in range(40)]
    pieces = [b"\xfd" + frames[0], *frames[1:]]
    parser, framer = _parser(), Framer(stream=True)
    theirs = sum(each.get_msgId() >= 0 for piece in pieces for each in parser.parse_buffer(piece) or ())
    ours = sum(len(framer.feed(piece, place * 0.05)) for place, piece in enumerate(pieces))
    ours += len(framer.expire(40 * 0.05))
    table = Table("40 MANUAL_CONTROL frames at 20 Hz in a stream, one stray 0xFD before them")
    table.rows = [{"parser": "pymavlink", "frames found": theirs}, {"parser": "ours", "frames found": ours}]
    report.tables.append(table)
    report.goals.append(
        Goal("frames lost to one stray byte", 40 - ours, 0, "frames", reference=f"pymavlink, {40 - theirs}")
    )
