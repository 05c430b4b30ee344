"""ScreenSet: all screens of a station, their lease to drive, and what each of them is sent."""

from __future__ import annotations

import asyncio
import logging
import socket
import time
from enum import Enum, auto
from typing import Protocol

import msgspec

from dialects.enums import Severity
from groundstation.host.screen_port import ScreenPort
from groundstation.intents.driving import DriveByPicture, DriveKeyDown, Stop
from groundstation.intents.session import Detach, Quit, RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.ipc import MAX_INTENT_AGE, IntentBatch, StationReady
from groundstation.snapshot import Snapshot
from groundstation.station.driving.screen_lease import Screen, ScreenLease
from groundstation.station.station import Station
from groundstation.station.view_feed import ViewFeed

log = logging.getLogger(__name__)

MAX_SCREENS = 8
"""Screens at once; each costs 10 snapshots/s."""


class _Attached(msgspec.Struct, eq=False):
    """One screen that is connected."""

    port: ScreenPort
    screen: Screen
    views: ViewFeed
    owner: bool
    """It has started this station."""
    leaving: bool = False
    """It waits for its vehicles to be disarmed."""


class Lifetime(Enum):
    """What ends a station."""

    SCREEN = auto()
    """The end of the screen that has started it, for whatever reason."""
    QUIT = auto()
    """Its driver quits, or the one that gave up the keys last. A screen that is killed or hung up leaves it running."""
    SIGNAL = auto()
    """A signal only."""


class StationEnd(Protocol):
    """What the screens may want of the process."""

    def handle(self, intent: AnyIntent, now: float, read_at: float) -> None:
        """Carry out an intent; its key was read at `read_at`."""

    def flush(self) -> None:
        """Send what intents have caused."""

    def note_screen(self, *, quits: bool, now: float) -> None:
        """Note that the screen that has started the station quits, or else that its process has ended."""

    def end(self, intent: Quit) -> None:
        """End the station, or change how it ends."""


class ScreenSet:
    """The screens of one station; the loop runs."""

    def __init__(self, station: Station, host: StationEnd, lifetime: Lifetime) -> None:
        self._station = station
        self.lease = ScreenLease(station.operator, station.driving, station.log)
        station.verbs.screen_that_drives = lambda: self.lease.holder.name if self.lease.holder else None
        station.proposals.permitting_screen = station.verbs.screen_that_drives
        self._host = host
        self._lifetime = lifetime
        self._attached: dict[ScreenPort, _Attached] = {}
        self._changed = False
        """What was read just now has done more than to renew the lease in time, or to hold a key on."""

    # ---- screens come and go ----

    def add(self, sock: socket.socket, name: str, *, owner: bool = False, watches: bool = False) -> str | None:
        """Add a screen. Return why not. `owner`: it has started this station; `watches`: it begins without keys."""
        if len(self._attached) >= MAX_SCREENS:
            return f"{MAX_SCREENS} screens are attached already"
        port = ScreenPort(sock, self)
        screen = self.lease.join(name, asyncio.get_running_loop().time(), watches=watches)
        views = self._station.views if owner else self._station.views.open_another()
        self._attached[port] = _Attached(port, screen, views, owner)
        if not owner:
            port.send(StationReady(self._station.station_info.endpoints, screen.first_request))
        port.start()
        return None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the screens, the one that has started the station first."""
        return tuple(each.screen.name for each in sorted(self._attached.values(), key=lambda each: not each.owner))

    def close(self) -> None:
        """End all connections."""
        for port in self._attached:
            port.close()
        self._attached.clear()

    def handle_screen_end(self, port: ScreenPort, now: float) -> None:
        """Go neutral if this screen drove."""
        attached = self._attached.get(port)
        self._changed = True
        if attached is not None:
            if attached.owner:
                self._host.note_screen(quits=False, now=now)
            if attached.owner and self._lifetime is Lifetime.SCREEN:
                self._host.end(Quit())
            self._remove(attached, now)

    def _remove(self, attached: _Attached, now: float) -> None:
        del self._attached[attached.port]
        attached.port.close()
        self.lease.leave(attached.screen, now)
        if attached.owner:
            attached.views.watch(())
        else:
            self._station.views.close_another(attached.views)

    # ---- what they want ----

    def handle_batch(self, port: ScreenPort, batch: IntentBatch, now: float) -> None:
        """Carry out the intents of one packet, but for those that are too old, or not for this screen to make."""
        attached = self._attached[port]
        for intent in batch.intents:
            if self._renews(attached, batch, intent, now) or self._prolongs(attached, batch, intent, now):
                continue
            self._changed = True
            if now - batch.time > MAX_INTENT_AGE and not intent.valid_when_late:
                self._log_late(intent, now - batch.time, now)
            elif isinstance(intent, Quit | Detach):
                self._leave(attached, intent, now)
            elif isinstance(intent, Watch) and not attached.owner:
                attached.views.watch(intent.requests)
            elif (allowed := self.lease.filter(attached.screen, intent, now)) is not None:
                self._host.handle(allowed, now, batch.time)

    def _renews(self, attached: _Attached, batch: IntentBatch, intent: AnyIntent, now: float) -> bool:
        """Renew the lease in time, ten times a second: no message and no view follows from that."""
        if not isinstance(intent, RenewLease) or now - batch.time > MAX_INTENT_AGE:
            return False
        holds = self.lease.filter(attached.screen, intent, now) is not None
        return not holds or self._station.renew_lease(now)

    def _prolongs(self, attached: _Attached, batch: IntentBatch, intent: AnyIntent, now: float) -> bool:
        """Hold a key on that repeats 30 times a second, or take a newer picture: no message and no view follows."""
        if not isinstance(intent, DriveKeyDown | DriveByPicture) or now - batch.time > MAX_INTENT_AGE:
            return False
        if attached.screen is not self.lease.holder:
            return False
        if isinstance(intent, DriveByPicture):
            return self._station.prolong_picture(intent, now)
        return self._station.prolong_key(intent, now)

    def finish_read(self, port: ScreenPort, now: float) -> None:
        """Send the messages of the intents, and the views that they have changed."""
        changed, self._changed = self._changed, False
        if not changed:
            return
        self._host.flush()
        if (attached := self._attached.get(port)) is not None:
            attached.views.send_due(port.send, now, time.time())

    def _log_late(self, intent: AnyIntent, age: float, now: float) -> None:
        if not isinstance(intent, RenewLease):
            text = f"{type(intent).__name__} arrived {age:.1f} s late and was dropped"
            log.warning(text)
            self._station.log.add(now, "station", text, Severity.WARNING)

    def _leave(self, attached: _Attached, intent: Quit | Detach, now: float) -> None:
        """Let a screen go that ends in order, and the station with it if that is its lifetime."""
        drives, last = attached.screen is self.lease.holder, self.lease.is_last_driver(attached.screen)
        ends = attached.owner if self._lifetime is Lifetime.SCREEN else self._lifetime is Lifetime.QUIT and last
        if attached.owner:
            self._host.note_screen(quits=True, now=now)
        if ends and (isinstance(intent, Quit) or self._lifetime is Lifetime.SCREEN):
            self._host.end(intent if isinstance(intent, Quit) else Quit())
        elif drives and isinstance(intent, Quit) and intent.disarm:
            self._station.shutdown.begin(now, disarm=True)
            attached.leaving = True
            self._host.handle(Stop("quitting"), now, now)
        else:
            self._remove(attached, now)

    # ---- what they see ----

    def send_views(self, now: float) -> None:
        """Send the views that are due to all, and end what waits for too long."""
        self.lease.tick(now)
        for attached in list(self._attached.values()):
            attached.views.send_due(attached.port.send, now, time.time())
            if attached.leaving and self._station.shutdown.finished:
                self._remove(attached, now)

    def show(self, snapshot: Snapshot, now: float) -> None:
        """Send the snapshot to all."""
        for attached in self._attached.values():
            attached.port.send(msgspec.structs.replace(snapshot, lease=self.lease.view(attached.screen, now)))
