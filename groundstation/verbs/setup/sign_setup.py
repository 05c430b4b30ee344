"""`mavhelm sign setup`: give a key to a vehicle with SETUP_SIGNING, over a serial or USB cable only.

The message holds the key in clear text, so it is sent neither over a network, nor over a telemetry radio, nor through a
station that runs. ArduPilot, PX4 and our own vehicle take it while they are disarmed.
https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence

from dialects import messages as m
from groundstation.vehicles.state.chunked_texts import TextJoiner
from groundstation.verbs.client.station_choice import AUTO, NEVER
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.setup.sign import one_line_errors
from link.core import Received
from link.endpoint import SERIAL, parse_endpoint
from link.protocol.frame import read_header
from link.protocol.log_tap import LogTap
from link.signing import key_actions
from link.signing.key_file import load_keys, station_key_file
from link.signing.keys import KeyRing, SigningKey
from link.signing.signature import SecretHash, is_signed

TRIES, PERIOD = 4, 1.5
"""How often the key is sent, and s for which the effect of each is awaited."""
SIGNING_EPOCH = 1_420_070_400
"""Unix time of 2015-01-01, from which timestamps of signing count in units of 10 us."""
UNITS = 100_000


def prepare(options: argparse.Namespace) -> None:
    """Find the key, and refuse every way that others could listen on. Raises VerbError, EndpointError."""
    if options.through not in (AUTO, NEVER):
        raise VerbError(ExitCode.USAGE, "a key does not go through a station: leave --station out")
    options.through = NEVER
    from groundstation.verbs.session.endpoints import choose_endpoints

    options.endpoints = choose_endpoints(options.endpoints, options.config, os.environ, reserved=options.reserved)
    for text in options.endpoints:
        if parse_endpoint(text).scheme != SERIAL:
            hint = "a key goes over a serial or USB cable only, for example -e serial:/dev/ttyACM0:115200"
            raise VerbError(ExitCode.USAGE, f"{text}: {hint}")
    with one_line_errors():
        options.key = _choose(load_keys(station_key_file()), options.name)


class Signers:
    """Who signs with a key. Its `log_tap` takes all frames of the links."""

    def __init__(self, key: SigningKey, ids: tuple[int, int]) -> None:
        self.systems: set[int] = set()
        self.log_tap = LogTap(self._look, system=ids[0], component=ids[1], unsent=False, signatures=True)
        self._hash = SecretHash(key.secret)

    def _look(self, now: float, frames: Sequence[bytes]) -> None:
        for raw in frames:
            header = read_header(raw, 0)
            if header is not None and is_signed(raw) and self._hash.matches(raw):
                self.systems.add(header.system)


def watch_signatures(options: argparse.Namespace, ids: tuple[int, int]) -> LogTap:
    """Return what looks for frames that are signed with the key."""
    options.signers = Signers(options.key, ids)
    tap: LogTap = options.signers.log_tap
    return tap


def _choose(ring: KeyRing, name: str | None) -> SigningKey:
    if not ring.keys:
        raise VerbError(ExitCode.USAGE, "there are no keys; `mavhelm sign new NAME` makes one")
    return key_actions.pick_key(ring, name if name is not None else ring.sign_with)


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Send the key until the vehicle signs with it, or says that it has it."""
    await session.need_only_vehicle(options.vehicle)
    await session.hear_all()
    _refuse_danger(session)
    key, answer = options.key, _Answer(session, options.key, options.signers)
    session.core.taps.append(answer.hear)
    for _ in range(TRIES):
        session.core.send(_build(session, key))
        session.flush()
        await session.wait_for(lambda: answer.known, PERIOD)
        if answer.known:
            break
    return _finish(session, answer, output)


def _refuse_danger(session: VerbSession) -> None:
    if session.vehicle.armed:
        raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} is armed: disarm it first")
    if any(kind is m.RadioStatus for _, kind in session.core.heard):
        raise VerbError(ExitCode.REFUSED, "a telemetry radio is on this link, and others can hear the key: use a cable")


def _build(session: VerbSession, key: SigningKey) -> m.SetupSigning:
    stamp = int(max(0.0, time.time() - SIGNING_EPOCH) * UNITS)
    return m.SetupSigning(session.vehicle.system, session.vehicle.component, key.secret, stamp)


class _Answer:
    """What the vehicle makes of the key."""

    def __init__(self, session: VerbSession, key: SigningKey, signers: Signers) -> None:
        self._session = session
        self.key = key
        self._signers = signers
        self._joiner = TextJoiner()
        self.confirmed: str | None = None
        """How it was confirmed, in its own words."""
        self.refusal: str | None = None

    @property
    def known(self) -> bool:
        """Whether it has the key, or has refused."""
        return self.has_key or self.refusal is not None

    @property
    def has_key(self) -> bool:
        """Whether it has the key: it says so, or its frames are signed with it."""
        return self.confirmed is not None or self._session.vehicle.system in self._signers.systems

    def hear(self, received: Received, now: float) -> None:
        """Store the texts of the vehicle that are about signing."""
        message = received.message
        if received.system != self._session.vehicle.system or not isinstance(message, m.StatusText):
            return
        text = self._joiner.add(message, received.system, received.component, now).text  # also if a chunk is missing
        if self.key.fingerprint in text:
            self.confirmed = text
        elif "sign" in text.lower():
            self.refusal = text


def _finish(session: VerbSession, answer: _Answer, output: Output) -> int:
    vehicle, key = session.vehicle, answer.key
    code = ExitCode.DONE if answer.has_key else ExitCode.REFUSED if answer.refusal else ExitCode.NO_ANSWER
    if answer.has_key:
        output.note(f"{vehicle.name} has the key {key.name} ({key.fingerprint})")
    elif answer.refusal:
        output.error(f"{vehicle.name}: {answer.refusal}")
    else:
        output.error(f"{vehicle.name} has not answered; it may not offer signing, or has another key already")
    output.result(code is ExitCode.DONE, vehicle.system, key=key.name, fingerprint=key.fingerprint)
    return code
