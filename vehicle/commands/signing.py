"""SETUP_SIGNING: a ground station gives this vehicle a key, over a cable and while disarmed."""

from __future__ import annotations

from typing import Protocol

import msgspec

from dialects.enums import Severity
from dialects.messages import RadioStatus, SetupSigning
from link.core import Received
from link.signing.keys import KeyRing, SigningKey
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.context import COMPONENT, Context
from vehicle.commands.inbound import InboundMessage, InboundTable
from vehicle.storage.store import PendingWrite

CABLE_ROLE = SigningRole.SET_UP
"""SigningRole of a key that came over a cable: who holds the vehicle in the hand may do anything with it."""
NAME = "cable-{}"
"""Name of such a key, with its fingerprint."""
OWN_COMPONENTS = (0, COMPONENT)


class KeyStore(Protocol):
    """Keeps keys beyond the end of the program: vehicle.runtime.vehicle_keys.VehicleKeys."""

    @property
    def ring(self) -> KeyRing:
        """The keys of now."""

    def add(self, key: SigningKey) -> PendingWrite:
        """Add a key; the vehicle obeys it soon after it is written. Never blocks."""


class Pairing(msgspec.Struct, frozen=True):
    """Where keys are kept, and the links over which one is accepted."""

    store: KeyStore
    cables: frozenset[int]
    """Indexes of the links that are serial or USB ports."""


class SigningCommands:
    """Handles SETUP_SIGNING. The key is neither logged nor repeated; texts have its fingerprint only."""

    def __init__(self, context: Context, pairing: Pairing | None) -> None:
        self._control = context.control
        self._safety = context.safety
        self._texts = context.statustext
        self._pairing = pairing
        self._radios: set[int] = set()
        """Links on which a telemetry radio has reported: what crosses them can be heard by anybody."""
        self._waiting: tuple[Received, SigningKey, PendingWrite] | None = None

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return (
            InboundMessage(SetupSigning, Access.ANYONE,
                           "adds a key with the role setup: over a serial or USB cable only, disarmed, and once the "
                           "vehicle has keys only if signed with one of that role; answered by a STATUSTEXT",
                           self._handle),
        )  # fmt: skip

    def observe(self, received: Received, now: float) -> None:
        """Note over which links radios report; called with every message."""
        if type(received.message) is RadioStatus:
            self._radios.add(received.peer.link)

    def tick(self, now: float) -> None:
        """Report a key that has been written."""
        if self._waiting is not None and self._waiting[2].done:
            received, key, written = self._waiting
            self._waiting = None
            if written.problem:
                self._reply(received, f"Signing: key not stored, {written.problem}", now)
            else:
                text = f"Signing: key {key.fingerprint} stored as {key.name}"
                self._reply(received, text, now, Severity.NOTICE)

    def _handle(self, received: Received, message: SetupSigning, now: float) -> None:
        if message.target_system != self._control.system or message.target_component not in OWN_COMPONENTS:
            return
        secret = bytes(message.secret_key)
        if problem := self._refusal(received, secret):
            self._reply(received, f"Signing: {problem}", now)
            return
        assert self._pairing is not None
        draft = SigningKey("cable", CABLE_ROLE, secret)
        key = SigningKey(NAME.format(draft.fingerprint), CABLE_ROLE, secret)
        ring = self._pairing.store.ring
        if (same := ring.find_fingerprint(key.fingerprint)) is not None:
            self._reply(received, f"Signing: key {same.fingerprint} is stored already", now, Severity.NOTICE)
        elif ring.refuse(key) is not None:
            self._reply(received, "Signing: refused, too many keys", now)
        elif self._waiting is None:  # a ground station repeats the message
            self._waiting = received, key, self._pairing.store.add(key)

    def _refusal(self, received: Received, secret: bytes) -> str | None:
        """Return why no key is taken now, in words for a STATUSTEXT; None if it is."""
        pairing, link = self._pairing, received.peer.link
        if pairing is None:
            return "refused, no folder for keys (--state)"
        if link not in pairing.cables:
            return "refused, use a serial or USB cable"
        if link in self._radios:
            return "refused, not over a radio"
        if self._safety.armed:
            return "refused while armed"
        if not any(secret):
            return "to remove: 'mavhelm vehicle key revoke'"
        if pairing.store.ring.keys and not self._may_add(received):
            return "refused: 'mavhelm vehicle key install'"
        return None

    def _may_add(self, received: Received) -> bool:
        """Return whether the message is signed with a key that may add others."""
        return received.signed and received.role >= SigningRole.SET_UP

    def _reply(self, received: Received, text: str, now: float, severity: Severity = Severity.WARNING) -> None:
        self._texts.reply(received, severity, text, now)
