"""Status bar: the vehicle, its mode, armed or not, who is in control, link quality and health."""

from __future__ import annotations

import time

import msgspec
from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.snapshot import EmergencyProgress, LinkView, RecordingView, ReplayStatus, Snapshot, VehicleView
from groundstation.snapshot.signing import SigningState, SigningView
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.look.colours import (
    AMBER,
    BLUE,
    DEEP_RED,
    DIM,
    FAINT,
    GREEN,
    RED,
    TEXT,
    VIOLET,
    YELLOW,
    badge,
    style,
)
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, length, strip
from groundstation.ui.widgets.tabs import WIDE, goto_parts

STALE_COMMAND, OLD_COMMAND = 0.45, 0.2
"""Age of a demand, s: from 0.45 on the vehicle no longer obeys (its MAN_TIMEOUT); 0.2 is four frames at 20 Hz."""

SILENT_LINK = 2.5
"""s of age from which on one of several links has no bar: two and a half heartbeats."""

_BARS, _NO_BAR = "▂▄▆█", "▁"
_MODES = {"MANUAL": GREEN, "HOLD": AMBER}


class StatusBarValue(msgspec.Struct, frozen=True):
    """The snapshot, and what is not in it."""

    snapshot: Snapshot
    keymap: Keymap
    terminal: float | None = None
    """Round trip to the terminal, s."""
    drives: bool = True
    """Keys drive on the screen on top."""
    drive_key: str = "?"
    """Key of the screen where they do."""
    station_runs: bool = True
    """The station process runs and responds."""
    muted: bool = False
    """Speech was asked for, and nothing is said."""

    @classmethod
    def from_state(cls, now: DisplayState) -> StatusBarValue:
        """Return the status bar of a display state."""
        runs = now.station_alive and not now.outage
        return cls(
            now.snapshot,
            now.keymap,
            now.terminal_round_trip,
            now.screen.drives,
            now.key("app.drive"),
            runs,
            now.muted,
        )


class StatusField(msgspec.Struct, frozen=True):
    """One reading; those of small weight stay longest where the line is short."""

    weight: int
    parts: tuple[Part, ...]


class StatusBar(Instrument[StatusBarValue]):
    """One line where all fits, else two."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the badges left, the rest right; on two lines the link readings go below."""
        snapshot = self.value.snapshot
        badges, health = self._badges(), [*_health(snapshot.vehicle), *_recording(snapshot.recording)]
        links, signing = _links(snapshot), _signing(snapshot.signing)
        numbered = len(_live_links(snapshot)) > 1
        fields = [*links, *_command(snapshot), *_terminal(self.value.terminal)]
        place = len(links) if numbered else 1
        fields[place:place] = signing
        if height > 1:
            goto = goto_parts(self.value.keymap)
            if sum(length(each.parts) for each in fields) + length(goto) > width:
                goto = goto[:1]  # the key alone
            return [
                _spread(badges, _fitting(health, width - length(badges)), width),
                _spread(_fitting(fields, width - length(goto)), goto, width),
            ]
        readings = [*(fields if width >= WIDE else [min(links, key=lambda each: each.weight), *signing]), *health]
        return [_spread(badges, _fitting(readings, width - length(badges) - 1), width)]

    def _badges(self) -> list[Part]:
        value, vehicle = self.value, self.value.snapshot.vehicle
        if value.snapshot.replay is not None:
            return _replay_badges(value.snapshot.replay, vehicle)
        if vehicle is None:
            return [(" mavhelm ", badge(BLUE)), (" no vehicle", style(DIM))]
        parts = [(f" {vehicle.name} ", badge(BLUE)), mode_badge(vehicle)]
        stands = not value.drives and vehicle.in_control and vehicle.armed and vehicle.obeys_keys
        watches = bool(value.snapshot.lease.driver)
        who = driver_part(vehicle, station_runs=value.station_runs, watches=watches)
        if stands and not watches and vehicle.alive and value.station_runs:
            who = (f"neutral · {value.drive_key} drives", style(AMBER, bold=True))
        parts += [*arming_badges(vehicle), (" ", style()), who]
        if value.snapshot.also_armed:
            systems = ", ".join(map(str, value.snapshot.also_armed))
            parts.append((f" also armed: {systems}", style(AMBER, bold=True)))
        return [*parts, *muted_parts(muted=value.muted)]


def _replay_badges(replay: ReplayStatus, vehicle: VehicleView | None) -> list[Part]:
    """Return the badges of a log: they look like no live vehicle."""
    shown = time.strftime("%H:%M:%S", time.localtime(replay.wall)) + f".{int(replay.wall * 10) % 10}"
    parts = [(" REPLAY ", badge(VIOLET))]
    if vehicle is not None:
        parts += [(f" {vehicle.name} ", badge(BLUE)), mode_badge(vehicle), *arming_badges(vehicle)]
    return [*parts, (f" {shown} · nothing is sent", style(VIOLET, bold=True))]


def _fitting(fields: list[StatusField], room: int) -> list[Part]:
    """Return the parts of the fields that fit, in order; the least important are left out first."""
    kept: set[int] = set()
    for place, candidate in sorted(enumerate(fields), key=lambda each: each[1].weight):
        if (size := length(candidate.parts)) <= room:
            kept.add(place)
            room -= size
    return [part for place, each in enumerate(fields) if place in kept for part in each.parts]


def _spread(left: list[Part], right: list[Part], width: int) -> Strip:
    gap = max(1, width - length(left) - length(right))
    return strip(*left, (" " * gap, style()), *right).crop(0, width)


def muted_parts(*, muted: bool) -> list[Part]:
    """Return that speech is muted: who listens for a failsafe must not wait for it in vain."""
    return [(" muted", style(AMBER, bold=True))] if muted else []


def mode_badge(vehicle: VehicleView) -> Part:
    """Return the badge of the mode."""
    return (f" {vehicle.mode} ", badge(_MODES.get(vehicle.mode, YELLOW)))


def arming_badges(vehicle: VehicleView) -> list[Part]:
    """Return the badges of arming: ARMED as long as the vehicle reports that, whatever was requested."""
    confirmed = vehicle.emergency_progress in (None, EmergencyProgress.ACCEPTED)
    if vehicle.emergency_stop and confirmed and not vehicle.armed:
        return [(" EMERGENCY STOP ", badge(RED))]
    state = (" ARMED ", badge(DEEP_RED)) if vehicle.armed else (" DISARMED ", style(TEXT, FAINT, bold=True))
    return [state, (" E-STOP SENT ", badge(RED))] if vehicle.emergency_stop else [state]


def driver_part(vehicle: VehicleView, *, station_runs: bool, watches: bool) -> Part:
    """Return who moves the vehicle. `station_runs`: the station responds. `watches`: this screen does not drive."""
    if not station_runs:
        return ("station lost", style(RED, bold=True))
    if not vehicle.alive:
        return (f"link lost for {vehicle.silence:.0f} s", style(RED, bold=True))
    if vehicle.obeys:
        return ("obeys another GCS", style(AMBER, bold=True))
    if vehicle.undriven:
        return ("only shown", style(AMBER, bold=True))
    if vehicle.in_control:
        return _own_part(vehicle, watches=watches)
    if vehicle.driver:
        who = f"another {vehicle.driver}" if vehicle.duplicate_gcs else f"{vehicle.driver}"
        return (f"driven by {who}", style(AMBER, bold=True))
    return ("" if vehicle.driver is None else "no GCS in control", style(DIM))


def _own_part(vehicle: VehicleView, *, watches: bool) -> Part:
    """Return what moves a vehicle that this station controls."""
    if vehicle.armed and vehicle.emergency_stop:
        return ("", style())  # the keys do not drive, and the badge before it says why
    if watches:
        return ("you watch", style(AMBER, bold=True))
    if vehicle.drives_itself:
        return (f"{vehicle.mode} drives", style(YELLOW, bold=True))
    return ("you drive" if vehicle.armed and vehicle.drivable else "you are in control", style(GREEN, bold=True))


def _field(weight: int, name: str, text: str, colour: str = TEXT) -> StatusField:
    return StatusField(weight, ((f" {name} ", style(DIM)), (f"{text} ", style(colour))))


def _links(snapshot: Snapshot) -> list[StatusField]:
    if not snapshot.links:
        return [_field(1, "link", "none", DIM)]
    alive = snapshot.vehicle is not None and snapshot.vehicle.alive
    several = _live_links(snapshot)
    if len(several) > 1:
        return [_numbered(number, each) for number, each in several]
    link = min(snapshot.links, key=_by_loss)
    loss, trip = finite_or_none(link.loss), finite_or_none(link.round_trip)
    bars, colour = _quality(link, alive)
    strength = StatusField(
        1, ((" link ", style(DIM)), (_BARS[:bars], style(colour)), (f"{_NO_BAR * (4 - bars)} ", style(FAINT)))
    )
    return [
        strength,
        _field(2, "loss", "--" if loss is None else f"{100 * loss:.1f}%", TEXT if (loss or 0) < 0.05 else AMBER),
        _field(2, "rtt", "--" if trip is None else f"{1000 * trip:.0f} ms", TEXT if (trip or 0) < 0.2 else AMBER),
    ]


def _live_links(snapshot: Snapshot) -> list[tuple[int, LinkView]]:
    """Return the links on which the selected vehicle is heard, with their numbers; none while it is lost."""
    alive = snapshot.vehicle is not None and snapshot.vehicle.alive
    return [(number, each) for number, each in enumerate(snapshot.links, 1) if alive and each.age is not None]


def _by_loss(link: LinkView) -> tuple[bool, bool, float]:
    """Order links: that of the vehicle that counts first, then those that have lost less."""
    loss = finite_or_none(link.loss)
    return not link.counts, loss is None, loss or 0.0


def _numbered(number: int, link: LinkView) -> StatusField:
    """Return one of several links to the vehicle: loss, round trip and age; the one that counts has a mark."""
    loss, trip, age = map(finite_or_none, (link.loss, link.round_trip, link.age))
    bars, colour = _quality(link, age is not None and age < SILENT_LINK)
    figures = [
        *([] if loss is None else [f"{100 * loss:.0f}%"]),
        *([] if trip is None else [f"{1000 * trip:.0f} ms"]),
        *([] if age is None else [f"{age:.1f} s old"]),
    ]
    parts: tuple[Part, ...] = (
        (f"{'★' if link.counts else ' '}{number} ", style(GREEN if link.counts else DIM, bold=link.counts)),
        (_BARS[:bars], style(colour)),
        (_NO_BAR * (4 - bars), style(FAINT)),
        (f" {' '.join(figures)} ", style(TEXT if bars > 1 else AMBER)),
    )
    return StatusField(1 if link.counts else 2, parts)


_SIGNING = {SigningState.OFF: DIM, SigningState.ON: GREEN, SigningState.NO_KEY: AMBER, SigningState.REQUIRED: AMBER}
"""State -> its colour; the others are red."""


def _signing(signing: SigningView | None) -> list[StatusField]:
    """Return the state in a word. What is wrong with it stays longest."""
    if signing is None:
        return []
    if signing.state is SigningState.OFF:  # "sign off" reads as the end of a session
        return [StatusField(3, ((" unsigned ", style(DIM)),))]
    more = f", refused {signing.refused}" if signing.state is SigningState.ON and signing.refused else ""
    colour = AMBER if more else _SIGNING.get(signing.state, RED)
    return [_field(3 if signing.well else 0, "sign", signing.state.value + more, colour)]


def _quality(link: LinkView, alive: bool) -> tuple[int, str]:
    if not alive:
        return 0, RED
    lost = finite_or_none(link.loss) or 0.0
    full = 4 - sum(lost > limit for limit in (0.02, 0.10, 0.25))
    return full, (RED, RED, AMBER, GREEN, GREEN)[full]


def _command(snapshot: Snapshot) -> list[StatusField]:
    vehicle = snapshot.vehicle
    fields = [_field(5, "sent", f"{snapshot.operator.rate:.0f} Hz", TEXT if snapshot.operator.sending else DIM)]
    if vehicle is None:
        return []
    age, latency = finite_or_none(vehicle.command_age), finite_or_none(vehicle.latency)
    if age is not None and age < 10:
        colour = DIM if not vehicle.armed else GREEN if age < OLD_COMMAND else AMBER if age < STALE_COMMAND else RED
        estimate = "~" if vehicle.command_age_estimated else ""
        fields.append(_field(1, "cmd", f"{estimate}{1000 * age:.0f} ms", colour))
    if latency is not None:
        fields.append(_field(3, "key→motor", f"{1000 * latency:.1f} ms", TEXT if latency < 0.1 else AMBER))
    return fields


def _terminal(trip: float | None) -> list[StatusField]:
    return [] if trip is None else [_field(4, "tty", f"{1000 * trip:.0f} ms", TEXT if trip < 0.2 else AMBER)]


def _health(vehicle: VehicleView | None) -> list[StatusField]:
    if vehicle is None:
        return []
    fields: list[StatusField] = []
    if vehicle.prearm is not None and not vehicle.armed:
        fields.append(_field(3, "pre-arm", "ok", GREEN) if vehicle.prearm else _field(1, "pre-arm", "failed", AMBER))
    if vehicle.gps_fix is not None:
        fix = {0: "none", 1: "none", 2: "2D", 3: "3D"}.get(vehicle.gps_fix, "RTK" if vehicle.gps_fix > 4 else "DGPS")
        count = "" if vehicle.gps_satellites is None else f" {vehicle.gps_satellites}"
        fields.append(_field(2, "gps", fix + count, GREEN if vehicle.gps_fix >= 3 else AMBER))
    volts, left = finite_or_none(vehicle.battery_voltage), finite_or_none(vehicle.battery_remaining)
    if volts is not None:
        colour = GREEN if left is None or left > 0.3 else AMBER if left > 0.15 else RED
        rest = "" if left is None else f" {100 * left:.0f}%"
        lasts = vehicle.battery_left if vehicle.flies else None
        amount = f"{volts:.1f} V" if lasts is None else f"{lasts / 60:.0f} min"
        fields.append(_field(1, "batt", f"{amount}{rest}", colour))
    return fields


def _recording(recording: RecordingView | None) -> list[StatusField]:
    dot = recording_parts(recording)
    return [StatusField(0, dot), StatusField(6, (("rec ", style(DIM)),))] if dot else []


def recording_parts(recording: RecordingView | None) -> tuple[Part, ...]:
    """Return the red dot while the session is recorded."""
    if recording is None or recording.problem or not recording.path:
        return ()
    return (("● ", style(RED, bold=True)),)


def health_parts(vehicle: VehicleView) -> list[Part]:
    """Return GPS and battery."""
    return [part for field in _health(vehicle) for part in field.parts]
