"""What to do next, in a line of its own that no alert hides."""

from __future__ import annotations

from groundstation.snapshot import ReplayStatus, VehicleView
from groundstation.ui.display.display_state import DisplayState


def hint(now: DisplayState) -> str:
    """Return what to do next."""
    if now.unseen_lesson:
        return now.unseen_lesson
    if not now.screen.drives:
        return now.screen.hint
    if now.snapshot.replay is not None:
        return _replay_hint(now, now.snapshot.replay)
    return f"{_drive_hint(now)}{_gamepad_hint(now)}"


def _gamepad_hint(now: DisplayState) -> str:
    """Return which button of the gamepad arms, or drives if keys would."""
    vehicle = now.snapshot.vehicle
    if now.gamepad is None or vehicle is None or vehicle.undriven or now.snapshot.lease.driver:
        return ""
    drivable = vehicle.in_control and vehicle.obeys_keys and not vehicle.obeys
    pad = now.gamepad.hint(armed=vehicle.armed) if drivable or not vehicle.armed else ""
    return f" · {pad}" if pad else ""


def _replay_hint(now: DisplayState, replay: ReplayStatus) -> str:
    return f"replay of {replay.file}: keys do not drive · {now.key('app.goto')} 0 plays, seeks, searches"


def _drive_hint(now: DisplayState) -> str:
    vehicle = now.snapshot.vehicle
    if vehicle is None:
        return f"no vehicle yet · {now.key('app.help')} shows the keys, {now.key('app.quit')} quits"
    if now.snapshot.lease.driver:
        return f"SPACE stops, {now.key('stop.emergency')} cuts the motors, {now.key('app.quit')} leaves the station"
    return _vehicle_hint(vehicle, now)


def _vehicle_hint(vehicle: VehicleView, now: DisplayState) -> str:
    if not vehicle.alive:
        return "link lost: no key is heard until it is back"
    if vehicle.undriven:
        asks = "asks, then " if vehicle.may_fall else ""
        return f"{vehicle.undriven} · {now.key('stop.emergency')} {asks}cuts the motors"
    if not vehicle.armed:
        return _arming_hint(vehicle, now)
    if vehicle.flies:
        return _flight_hint(vehicle, now)
    stops = f"SPACE stops, {now.key('stop.emergency')} cuts the motors"
    if vehicle.obeys:
        return stops
    if not vehicle.in_control:
        return f"{now.key('vehicle.control')} asks for control · {stops}"
    if vehicle.mode != "MANUAL":
        return f"{vehicle.mode}: {now.key('vehicle.manual')} changes to MANUAL, where the keys drive"
    verb = "hold" if now.snapshot.operator.style == "hold" else "press"
    return f"{verb} {now.key('drive.forward')} to drive · {stops}"


def _flight_hint(vehicle: VehicleView, now: DisplayState) -> str:
    """Return what a pilot can do next: the stops of what flies are its landing, and the key after which it falls."""
    emergency, cut = now.key("stop.emergency"), now.key("stop.cut")
    if not vehicle.may_fall:
        return f"on the ground: {_take_off_hint(vehicle, now)} · {emergency} disarms"
    stops = f"SPACE hovers, {emergency} lands, {cut} held 2 s: IT FALLS"
    if vehicle.obeys:
        return stops
    if not vehicle.in_control:
        return f"{now.key('vehicle.control')} asks for control · {stops}"
    if not vehicle.drivable:
        return f"{vehicle.mode}: {now.key('vehicle.manual')} changes to {vehicle.keys_mode} · {stops}"
    climbs = f"{now.key('drive.climb')} {now.key('drive.descend')} climb"
    return f"{stops} · {now.key('drive.forward')} flies, {climbs}"


def _take_off_hint(vehicle: VehicleView, now: DisplayState) -> str:
    key, altitude, fence = now.key("vehicle.take_off"), vehicle.take_off, vehicle.altitude_fence
    if altitude is None:
        return f"hold {key} to take off"
    if fence is not None and altitude > fence:
        return f"no take-off to {altitude:g} m, its fence is at {fence:g} m"
    return f"hold {key} to take off to {altitude:g} m"


def _arming_hint(vehicle: VehicleView, now: DisplayState) -> str:
    if vehicle.prearm is False:
        # The key all the same: PX4 is not ready until it gets MANUAL_CONTROL, which arming begins with.
        reason = vehicle.prearm_reason or "pre-arm checks fail"
        return f"disarmed: hold {now.key('vehicle.arm')} to arm · not ready, {reason}"
    return f"disarmed: hold {now.key('vehicle.arm')} to arm {vehicle.name}"
