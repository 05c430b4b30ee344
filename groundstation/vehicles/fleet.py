"""All vehicles found, and the selected one. Notices when a vehicle appears, is lost and comes back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import msgspec

from dialects import messages as m
from dialects.axes import Axes, AxisMap, axis_map
from dialects.enums import Severity
from dialects.modes import Mode
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.snapshot.signing import SigningView
from groundstation.vehicles.demand.demand_copies import DemandCopies
from groundstation.vehicles.demand.demand_stream import DemandStream
from groundstation.vehicles.probes.dialect_probe import DialectProbe
from groundstation.vehicles.probes.signing_watch import SIGNING, SigningWatch
from groundstation.vehicles.probes.stream_requests import StreamRequests
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.drive_readings import DriveReadings
from groundstation.vehicles.state.message_log import STATE, MessageLog
from groundstation.vehicles.state.state_changes import StateChanges
from groundstation.vehicles.state.vehicle_details import VehicleDetails
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES, is_vehicle, replaces
from groundstation.vehicles.state.vehicle_params import VehicleParams
from groundstation.vehicles.state.vehicle_state import LOST_AFTER, VehicleState
from groundstation.vehicles.stops.altitude_fence import AltitudeFence
from groundstation.vehicles.stops.settings_check import SettingsCheck, find_settings
from link.core import LinkReport, Received


class Contact(msgspec.Struct):
    """A vehicle's state and what the station tracks for it."""

    state: VehicleState
    stream_requests: StreamRequests
    link: int
    """Index of the link that counts: of several the best (groundstation/vehicles/paths)."""
    changes: StateChanges
    details: VehicleDetails
    drive: DriveReadings
    settings_check: SettingsCheck | None = None
    demand_stream: DemandStream = msgspec.field(default_factory=lambda: DemandStream(DemandCopies()))
    dialect_probe: DialectProbe = msgspec.field(default_factory=DialectProbe)
    services: VehicleServices | None = None
    """Parameters, plans and files; None before the first request."""
    ours: bool = False
    """This station has armed or driven the vehicle since the vehicle was last disarmed."""
    releasing: bool = False
    """Control is being released: the final neutrals go out, and no demand follows."""
    closing: bool = False
    """The link to it is being closed: the final neutrals go out, and no demand follows."""
    demanded_at: float = -math.inf
    """When the newest demand was sent to it."""
    lost_at: float | None = None
    """When the last message arrived, while the link is lost."""
    signs: bool = False
    """The vehicle signs its frames, with a key that we do not have."""
    verified: bool = False
    """The vehicle signs its frames, with a key of ours."""
    axes: AxisMap | None = None
    """Of the newest demand."""

    @property
    def busy(self) -> bool:
        """Whether a request to it is under way."""
        return self.services is not None and bool(self.services.book.running)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Texts for the driver: why the vehicle may ignore us, and settings that would let it drive on."""
        settings = self.settings_check.warnings if self.settings_check else ()
        return (SIGNING, *settings) if self.signs else settings

    @property
    def take_off_refusal(self) -> str:
        """Why keys may not take it off: what it would do without a link; "" if they may, and for what does not fly."""
        if not self.state.model.flies:
            return ""
        check = self.settings_check
        return "what it does without a link is not known" if check is None else check.take_off_refusal

    @property
    def altitude_fence(self) -> AltitudeFence | None:
        """How high its own fence lets it fly; None: there is no such fence, or it is not known."""
        return self.settings_check.altitude_fence if self.settings_check else None

    def choose_axes(self, demand: Axes) -> AxisMap:
        """Return the axes of MANUAL_CONTROL that this vehicle uses.

        They change only with a neutral demand: a frame that is read late must not turn the steering while driving.
        """
        if self.axes is None or demand.neutral:
            frame = self.settings_check.frame if self.settings_check else self._drive
            self.axes = axis_map(self.state.autopilot, self.state.kind, frame)
        return self.axes

    @property
    def _drive(self) -> int | None:
        """The drive type of our own vehicle, where it decides on the axes: in ACRO the steering is a turn rate."""
        info = self.state.drive_info
        return None if info is None or self.state.mode == Mode.ACRO.name else int(info.drive_type)

    @property
    def link_loss_action(self) -> str | None:
        """What the vehicle does when it loses us, as a text; None: not known.

        Our own vehicle has failsafes for driving by hand; a foreign one does what its settings say. In an autonomous
        mode other settings decide, which are not read.
        """
        if self.state.drives_itself:
            return None
        if self.state.has_rover_dialect:
            return "it stops by itself"
        return self.settings_check.link_loss_action if self.settings_check else None

    def lose(self, now: float) -> None:
        """Mark the vehicle as lost since its last message."""
        self.lost_at = now - self.state.monitor.silence(now)

    def restore(self, now: float) -> None:
        """Mark the vehicle as back. It may have restarted and forgotten everything that was requested of it."""
        self.lost_at = None
        self.stream_requests.restart(now)
        self.dialect_probe = DialectProbe()
        self.check_settings_again()

    def check_settings_again(self) -> None:
        """Read the settings again: after a restart they may be others."""
        if self.settings_check is not None:
            self.settings_check.restart()
        self.drive.params.restart()
        if self.services is not None:
            self.services.params.forget()


class Fleet:
    """The contacts by system id. `system` and `component` are our ids."""

    def __init__(self, log: MessageLog, system: int, component: int) -> None:
        self._log = log
        self._own_id = (system, component)
        self.signing = SigningWatch(system)
        self._contacts: dict[int, Contact] = {}
        self._selected: Contact | None = None
        self.on_first: Callable[[], object] = lambda: None
        """Called when the first vehicle is found."""
        self.is_meant: Callable[[Received], bool] = lambda received: False
        """Returns whether a new vehicle is the one that this program is for, so that it gets a place."""
        self._not_shown: dict[int, float] = {}
        """System id of a vehicle for which there is no place -> when it was heard last."""

    def __iter__(self) -> Iterator[Contact]:
        return iter(self._contacts.values())

    @property
    def selected(self) -> Contact | None:
        """The vehicle that the operator sees and drives."""
        return self._selected

    @property
    def system_ids(self) -> tuple[int, ...]:
        """System ids of all contacts, in rising order."""
        return tuple(sorted(self._contacts))

    @property
    def not_shown(self) -> int:
        """How many vehicles are heard for which there is no place."""
        return len(self._not_shown)

    @property
    def also_armed(self) -> tuple[int, ...]:
        """System ids of the vehicles that report armed besides the selected one, also of lost ones."""
        armed = (contact.state.system for contact in self if contact is not self._selected and contact.state.armed)
        return tuple(sorted(armed))

    def get(self, system: int) -> Contact | None:
        """Return the contact with this system id, or None."""
        return self._contacts.get(system)

    def addressed(self, message: m.Message) -> list[VehicleState]:
        """Return the vehicles that a message is for; without a target (0) it goes to all of them."""
        if system := m.target_system(message):
            contact = self._contacts.get(system)
            return [] if contact is None else [contact.state]
        return [contact.state for contact in self._contacts.values()]

    def name_of(self, system: int) -> str:
        """Return the name of the vehicle with this id; "" where there is none."""
        contact = self._contacts.get(system)
        return contact.state.name if contact else ""

    def take_off_refusal(self, system: int) -> str:
        """Return why keys may not take off this vehicle, see Contact; "" if they may."""
        contact = self._contacts.get(system)
        return contact.take_off_refusal if contact else ""

    def altitude_fence(self, system: int) -> AltitudeFence | None:
        """Return how high its own fence lets this vehicle fly, see Contact."""
        contact = self._contacts.get(system)
        return contact.altitude_fence if contact else None

    def select(self, system: int, now: float) -> None:
        """Select the vehicle with this system id, if there is one."""
        contact = self._contacts.get(system)
        if contact is None:
            self._log.add(now, "station", f"no vehicle with system id {system}", Severity.WARNING)
        elif contact is not self._selected:
            self._selected = contact
            self._log.add(now, "station", f"{contact.state.name} selected", Severity.NOTICE)

    def select_next(self, now: float) -> None:
        """Select the vehicle with the next higher system id; after the last comes the first."""
        systems = self.system_ids
        if len(systems) < 2 or self._selected is None:
            self._log.add(now, "station", "no other vehicle", Severity.NOTICE)
            return
        at = systems.index(self._selected.state.system)
        self.select(systems[(at + 1) % len(systems)], now)

    def forget(self, system: int, now: float) -> None:
        """Forget a vehicle, e.g. because the operator closed the link to it. The next one is selected in its place."""
        contact = self._contacts.pop(system, None)
        if contact is None:
            return
        self._log.add(now, "station", f"{contact.state.name} left out: its link is closed", Severity.NOTICE)
        if contact is self._selected:
            self._selected = None
            if self._contacts:
                self.select(self.system_ids[0], now)

    def get_or_add(self, received: Received, now: float) -> Contact | None:
        """Return the contact that sent a message; the HEARTBEAT of a new vehicle adds one."""
        contact = self._contacts.get(received.system)
        if contact is not None:
            best = contact.state.paths.best
            contact.link = received.peer.link if best is None else best.peer.link
            if replaces(received.component, contact.state.component) and is_vehicle(received.message):
                self._change_component(contact, received, now)
        if contact is not None or not is_vehicle(received.message):
            return contact
        if len(self._contacts) >= MAX_VEHICLES and not self._make_room(received, now):
            self._leave_out(received.system, now)
            return None
        self._not_shown.pop(received.system, None)
        state = VehicleState(received.system, received.component)
        state.receive(received, now)
        target = (state.system, state.component)
        contact = Contact(
            state,
            StreamRequests(target, now),
            received.peer.link,
            StateChanges(self._own_id[0]),
            VehicleDetails(state.component),
            DriveReadings(state, VehicleParams(*self._own_id, target=target)),
            verified=received.signed,
        )
        state.paths.on_new = lambda at: contact.stream_requests.restart(at)  # a link has rates of its own
        self._contacts[received.system] = contact
        self._check_settings(contact)
        self._log.add(now, "station", f"{state.name} found", Severity.NOTICE)
        if self._selected is None:
            self._selected = contact
            self.on_first()
        return contact

    def _check_settings(self, contact: Contact) -> None:
        """Read the settings that matter for a stop, of an autopilot for which they are known."""
        state = contact.state
        rules, target = find_settings(state.autopilot, flies=state.model.flies), (state.system, state.component)
        if rules is not None and state.model.is_driven:
            contact.settings_check = SettingsCheck(rules, *self._own_id, target=target)

    def _change_component(self, contact: Contact, received: Received, now: float) -> None:
        """Handle another component of the system for the vehicle: its autopilot, which was not heard first."""
        state, system, component = contact.state, contact.state.system, received.component
        text = f"vehicle {system}: component {component} is its autopilot, not {state.component}"
        self._log.add(now, "station", text, Severity.WARNING, origin=LogOrigin(system))
        state.change_component(component)
        state.receive(received, now)
        target = (system, component)
        contact.stream_requests = StreamRequests(target, now)
        contact.changes, contact.details = StateChanges(self._own_id[0]), VehicleDetails(component)
        contact.drive = DriveReadings(state, VehicleParams(*self._own_id, target=target))
        contact.settings_check, contact.axes, contact.dialect_probe = None, None, DialectProbe()
        self._check_settings(contact)
        if contact.services is not None:
            contact.services.change_component(component, now)

    def _make_room(self, received: Received, now: float) -> bool:
        """Give a vehicle that signs with a key of ours, or is meant, the place of another; return whether there is one.

        Ids are invented easily, signatures are not. The selected vehicle, those that we armed or drove, and those with
        a request under way stay.
        """
        if not received.signed and not self.is_meant(received):
            return False
        others = [each for each in self if not (each.verified or each.ours or each is self._selected or each.busy)]
        if not others:
            return False
        leaving = min(others, key=lambda each: (each.state.armed, each.state.heartbeat_at))
        del self._contacts[leaving.state.system]
        self._leave_out(leaving.state.system, now)
        return True

    def _leave_out(self, system: int, now: float) -> None:
        """Count a vehicle for which there is no place; only the first is logged, so that a flood fills no log."""
        if not self._not_shown:
            text = f"more than {MAX_VEHICLES} vehicles: vehicle {system} and further ones are not shown"
            self._log.add(now, "station", text, Severity.WARNING)
        self._not_shown[system] = now

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Notice which vehicles sign their frames."""
        self.signing.observe(reports, now)
        verified = {system for report in reports for system in report.verified}
        signing = {system for report in reports for system in report.signing} - verified
        for contact in self._contacts.values():
            before, contact.signs = contact.signs, contact.state.system in signing
            contact.verified = contact.state.system in verified
            if contact.signs and not before:
                self._log.add(now, "station", f"{contact.state.name}: {SIGNING}", Severity.WARNING)

    def signing_of(self, contact: Contact | None, now: float) -> SigningView | None:
        """Return what is known of signing with a vehicle; without one, of the system whose frames are refused."""
        if contact is None:
            return self.signing.find_refused(now)
        alive, system = contact.lost_at is None, contact.state.system
        return self.signing.build_view(system, now, alive=alive, verified=contact.verified, signs=contact.signs)

    def update(self, now: float) -> None:
        """Notice which vehicles are lost and which are back, and what has changed."""
        self._not_shown = {system: at for system, at in self._not_shown.items() if now - at <= LOST_AFTER}
        for contact in self._contacts.values():
            monitor, name = contact.state.monitor, contact.state.name
            for change in contact.changes.update(contact.state):
                origin = LogOrigin(contact.state.system)
                self._log.add(now, STATE, f"{name}: {change}", Severity.NOTICE, origin=origin)
            if contact.lost_at is None and not monitor.is_alive(now):
                contact.lose(now)
                self._log.add(now, "station", f"{name}: link lost for {monitor.timeout:g} s", Severity.CRITICAL)
            elif contact.lost_at is not None and monitor.is_alive(now):
                self._log.add(now, "station", f"{name}: link back after {now - contact.lost_at:.1f} s", Severity.NOTICE)
                contact.restore(now)
