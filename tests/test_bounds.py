"""Bounds of what stops, which frames count and who gets in, as numbers: elsewhere tests use the constants.

docs/safety.md and docs/security.md promise most of them.
"""

from __future__ import annotations

import importlib

import pytest

DAY = 86_400 * 100_000
"""In timestamps of 10 us."""


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("vehicle.drive.driver.SUCCESSION_TIME", 0.7),
        ("vehicle.drive.driver.CLASH_PAUSE", 0.7),
        ("vehicle.drive.operator_session.PROOF_VALID", 1.0),
        ("vehicle.drive.gate.MOTOR_TEST_THROTTLE_MAX", 0.3),
        ("vehicle.drive.gate.MOTOR_TEST_TIME_MAX", 3.0),
        ("vehicle.safety.monitor.LATE_CYCLE_TIME", 0.1),
        ("vehicle.safety.monitor.BAD_CYCLES_MAX", 3),
        ("vehicle.navigation.estimator.GPS_LOST", 3.0),
        ("vehicle.safety.battery.CRITICAL_TIMER", 3.0),
        ("vehicle.safety.battery.SENSOR_TIMEOUT", 5.0),
        ("vehicle.safety.failsafe.BLOCKED_SPEED_MAX", 0.05),
        ("vehicle.safety.failsafe.BLOCKED_THROTTLE_MIN", 0.2),
        ("vehicle.drive.gate.RAMP_TOLERANCE", 0.05),
        ("groundstation.station.driving.stall.STALL_TIMEOUT", 0.3),
        ("groundstation.station.driving.stall.REST_STALL_TIMEOUT", 1.0),
        ("groundstation.watchdog.watchdog.SEND_FOR", 5.0),
        ("groundstation.watchdog.feed.END_WITHIN", 0.3),
        ("groundstation.watchdog.feed.MAX_ADDRESSES", 256),
        ("groundstation.watchdog.outlets.READ", 65536),
        ("groundstation.watchdog.report.MAX_REPORT", 65536),
        ("groundstation.watchdog.report.MAX_OUTLETS", 32),
        ("groundstation.watchdog.terminal_reset.LAST_TRY", 2.0),
        ("groundstation.watchdog.neutral.SEQUENCE_LEAD", 40),
        ("groundstation.station_socket.connect.SOCKET_BUFFER", 1_048_576),
        ("groundstation.station_socket.folder.LONGEST_ADDRESS", 107),
        ("groundstation.station_socket.hello.MAX_HELLO", 4096),
        ("groundstation.station_socket.hello.HELLO_WITHIN", 2.0),
        ("groundstation.station_socket.names.ANSWER_WITHIN", 0.05),
        ("groundstation.station_socket.names.MAX_ANSWER", 131_072),
        ("groundstation.station_socket.relay.MAX_RELAYED", 65536),
        ("groundstation.station_socket.relay.BATCH", 100),
        ("groundstation.station_socket.relay.ALIVE_PERIOD", 0.1),
        ("groundstation.station_socket.relay.KEEP", 30.0),
        ("link.protocol.address_budget.FACTOR", 100),
        ("link.protocol.address_budget.FIRST_REQUEST", 8192),
        ("link.protocol.address_budget.LIMIT", 65536),
        ("link.fleet.keys.MAX_KEYS", 8192),
        ("groundstation.input.hold_to_confirm.MIN_REPEATS", 5),
        ("groundstation.input.hold_to_confirm.MAX_EVENTS", 8),
        ("groundstation.input.key_repeat.PRESS_WINDOW", 0.75),
        ("groundstation.input.key_repeat.PRESS_WINDOW_MIN", 0.35),
        ("groundstation.input.key_repeat.PRESS_WINDOW_MAX", 1.1),
        ("groundstation.input.key_repeat.JITTER", 0.1),
        ("groundstation.input.key_repeat.PROOF", 5),
        ("groundstation.input.pad.HELD_PERIOD", 0.05),
        ("groundstation.input.pad.IDLE_PERIOD", 0.5),
        ("groundstation.input.keymap_file.MAX_SIZE", 262_144),
        ("groundstation.input.style.LOWEST_LIMIT", 0.1),
        ("groundstation.input.style.HIGHEST_LIMIT", 1.0),
        ("groundstation.web.door.MAX_WAITING", 32),
        ("groundstation.web.door.REQUEST_WITHIN", 5.0),
        ("groundstation.web.door.LINES", 20),
        ("groundstation.web.door.MINUTE", 60.0),
        ("groundstation.input.key_repeat.REPEAT_WINDOW", 0.2),
        ("groundstation.input.key_repeat.REPEAT_WINDOW_MIN", 0.12),
        ("groundstation.input.key_repeat.REPEAT_WINDOW_MAX", 0.25),
        ("groundstation.input.key_repeat.REPEAT_GAP", 0.12),
        ("groundstation.input.key_repeat.SHORTEST_DELAY", 0.2),
        ("groundstation.input.key_repeat.LONGEST_DELAY", 1.1),
        ("groundstation.input.key_repeat.GAPS_TO_LEARN", 20),
        ("groundstation.intents.session.LEASE_TIMEOUT", 0.3),
        ("groundstation.intents.session.REST_LEASE_TIMEOUT", 1.0),
        ("groundstation.intents.driving.HOLD_TIME", 1.0),
        ("groundstation.station.driving.motor_test.LONGEST", 2.0),
        ("groundstation.station_socket.relay.ALIVE_WITHIN", 0.3),
        ("groundstation.station.driving.handover.ANSWER_WITHIN", 10.0),
        ("groundstation.input.pad_stick.PAD_WINDOW", 0.25),
        ("groundstation.station.driving.departure.DISARM_TIMEOUT", 2.0),
        ("link.signing.verifier.NEW_STREAM_WINDOW", 6_000_000),
        ("link.signing.verifier.CRASH_WINDOW", 500_000),
        ("link.signing.verifier.PINNED_FOR", 10.0),
        ("link.signing.verifier.AHEAD_MAX", DAY),
        ("link.signing.clock.BOOT_LEAD", 6_000_000),
        ("link.signing_keeper.STORE_PERIOD", 30.0),
        ("link.signing.signature.DIGEST_SIZE", 6),
        ("link.signing.streams.MAX_STREAMS", 64),
        ("link.protocol.peer_table.PEER_SILENCE", 10.0),
        ("link.protocol.peer_table.OWNER_PLACES", 4),
        ("link.protocol.peer_table.RESERVED_PLACES", 4),
        ("link.protocol.signing_guard.COPY_DELAY", 500_000),
        ("link.signing.streams.SPAN", 30 * DAY),
        ("link.signing.clock.FOLLOWED_MAX", (4_102_444_800 - 1_420_070_400) * 100_000),
        ("link.protocol.peer_table.RUN_SILENCE", 1.5),
        ("vehicle.rover.STOP_ANSWER_PERIOD", 1.0),
        ("link.protocol.signing_guard.ANSWER_PERIOD", 1.0),
    ],
)
def test_a_bound_is_this_number(name: str, value: float) -> None:
    module, _, constant = name.rpartition(".")
    assert getattr(importlib.import_module(module), constant) == value
