"""Which tests run: `pytest` alone runs the short suite, `--suite all` every test, `--suite rest` those that are left.

The short suite is for everybody who has a clone: the cores and the safety code in virtual time, all that needs no other
program, and the main job with the real ones. It takes 190 s of CPU and skips nothing with the packages of the extra
`test`. A new test belongs to it, unless one of MARKERS or a row of LONG says otherwise; of a long table of parameters
ROWS do. Tests that are named on the command line always run.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Sequence
from pathlib import Path

import pytest

SHORT, REST, ALL = SUITES = ("short", "rest", "all")
TESTS = Path(__file__).parent

MARKERS = ("slow", "e2e", "interop", "tmux")
"""Tests with one of them are not in the short suite, but for those of MAIN_JOB."""
MARKED = ("e2e", "interop")
"""Folders in which every test has one."""

LONG = (
    "animation/test_drawing.py", "animation/test_recorder.py",
    "benchmarks", "test_benchmark_run.py", "fuzz", "mutation", "oldest", "packages", "recipes", "soak", "stress",
    "test_agents.py", "test_ci_again.py", "test_examples.py", "test_order.py", "test_suite.py",
    "test_release.py::test_a_signature",
    "test_keys_to_motion.py::test_every_key_and_chord", "test_missions.py", "test_roaming.py",
    "test_secure_by_default.py::test_no_data_becomes_code", "test_signed_stops.py::test_every_stop_stops_a_rover",
    "test_stop_worlds.py", "test_stops.py::test_a_key_held_over_another_screen",
    "dialects/extra", "dialects/test_build.py", "dialects/test_codec.py::test_every_message_that_we_make",
    "dialects/test_fingerprint.py::test_pytest_stops",
    "link/bridge/test_bridge.py", "link/bridge/fleet/test_members.py", "link/bridge/fleet/test_self_probe.py",
    "link/routing/test_routes.py::test_strangers",
    "link/runtime/test_stdio.py", "link/runtime/test_without_openssl.py",
    "link/services/ftp/test_handlers.py::test_any", "link/services/param/test_recorded_params.py",
    "link/services/test_any_bytes.py",
    "link/signing/test_c_library.py", "link/signing/test_verifier.py::test_81",
    "link/transport/test_udp.py::test_datagrams_that_are_kept",
    "vehicle/test_identity.py::test_a_session_is_moved", "vehicle/test_identity.py::test_copy_at_any_lag",
    "vehicle/test_identity.py::test_still_older_frames", "vehicle/test_identity.py::test_a_driver_who_comes_back",
    "vehicle/test_keys_apart.py::test_any_mix", "vehicle/test_rover_any_input.py",
    "vehicle/test_stops_in_a_crowd.py::test_a_new_station_stops_a_rover",
    "vehicle/autonomy/test_autonomous_stops.py::test_no_command_moves", "vehicle/commands/test_hand_over.py",
    "vehicle/commands/test_origin.py", "vehicle/drive/test_operator_session.py::test_no_demand_older",
    "vehicle/navigation/test_estimator.py", "vehicle/navigation/test_fence_avoidance.py",
    "vehicle/navigation/test_rally.py", "vehicle/safety/test_health_notices.py",
    "vehicle/sensors/ranging/test_time_of_flight.py", "vehicle/sim/test_drives.py",
    "vehicle/storage/test_plan_store.py::test_it_is_said_again", "vehicle/telemetry/test_bandwidth.py",
    "vehicle/telemetry/test_build_computer.py::test_no_reading", "vehicle/telemetry/test_build_navigation.py",
    "vehicle/telemetry/test_telemetry.py::test_no_reading",
    "vehicle/accessories/test_accessory_missions.py", "vehicle/autonomy/mission", "vehicle/autonomy/modes",
    "vehicle/autonomy/test_navigator.py", "vehicle/cli/test_motor_test.py", "vehicle/cli/test_systemd_unit.py",
    "vehicle/commands/test_go_to.py", "vehicle/commands/test_params.py::test_an_unsaved_value_is_retried",
    "vehicle/machine", "vehicle/motors/test_pins.py", "vehicle/sensors/test_gps.py::test_a_real_gpsd",
    "vehicle/storage/test_tlog_files.py::test_a_real_card",
    "groundstation/cli/local/test_keys.py", "groundstation/connect", "groundstation/export", "groundstation/gamepad",
    "groundstation/recording/test_power_cut.py", "groundstation/replay",
    "groundstation/station/doctor/test_diagnostics.py", "groundstation/station/services",
    "groundstation/test_ipc.py::test_the_version",
    "groundstation/station/driving/test_freeze.py",
    "groundstation/station/messages/test_recorded_traffic.py", "groundstation/test_foreign_missions.py",
    "groundstation/ui/app/test_command_line.py", "groundstation/ui/app/test_help.py",
    "groundstation/ui/charts/test_screen.py", "groundstation/ui/connect/test_screen.py",
    "groundstation/ui/drive/test_screen.py", "groundstation/ui/files/test_screen.py",
    "groundstation/ui/links/test_screen.py", "groundstation/ui/log/test_screen.py",
    "groundstation/ui/map/test_screen.py", "groundstation/ui/messages/test_screen.py",
    "groundstation/ui/params/test_screen.py", "groundstation/ui/setup/test_screen.py",
    "groundstation/ui/terminal/test_escape_sequences.py", "groundstation/ui/app/test_exit.py",
    "groundstation/ui/keys/test_hold.py", "groundstation/ui/terminal/test_interpreter.py",
    "groundstation/ui/terminal/test_mouse.py",
    "groundstation/ui/test_foreign_words.py",
    "groundstation/vehicles/probes/test_dialect_probe.py", "groundstation/vehicles/test_replay.py",
    "groundstation/vehicles/state/test_vehicle_state.py::test_no_message_breaks",
    "groundstation/verbs",
    "groundstation/watchdog/test_freezes.py::test_after_a_neutral_of_the_watchdog",
    "groundstation/formats/test_geojson_layer.py::test_10000",
    "groundstation/recent/test_recent_file.py::test_programs",
    "groundstation/station/charts/test_recorder.py::test_a_page_fits",
    "groundstation/station/messages/test_message_detail.py::test_a_fast_message",
    "groundstation/station/views/test_drive_display.py::test_speed_and_demand",
    "groundstation/station/views/test_link_views.py::test_vehicles_beyond",
    "groundstation/ui/files/test_log_summary.py::test_a_log_says",
    "groundstation/ui/terminal/test_drawn_lines.py::test_a_divided", "groundstation/web/test_door.py",
    "groundstation/web/test_launch.py",
    "link/services/ftp/test_client.py::test_any_answer", "link/test_runner.py::test_frames_returned",
    "vehicle/cli/test_pi_guide.py", "vehicle/cli/test_without_libraries.py",
    "vehicle/telemetry/test_schedule.py",
    "groundstation/cli/test_shared_verbs.py::test_serve_says",
    "groundstation/formats/test_geojson_layer.py::test_many_small",
    "groundstation/formats/test_plan_file.py::test_any_mission",
    "groundstation/formats/test_plan_file.py::test_no_json",
    "groundstation/input/test_sticks.py::test_timer_drive_ends",
    "groundstation/input/test_sticks.py::test_whatever_came_before",
    "groundstation/recording/test_session_recorder.py", "groundstation/station/driving/test_gamepad.py",
    "groundstation/station/driving/test_handover.py", "groundstation/station/driving/test_kinds.py",
    "groundstation/station/driving/test_motor_test.py", "groundstation/station/driving/test_screen_lease.py",
    "groundstation/station/driving/test_several_vehicles.py", "groundstation/station/test_readings.py",
    "groundstation/station/views/test_drive_display.py", "groundstation/station/views/test_link_views.py",
    "groundstation/station/views/test_param_views.py", "groundstation/ui/drive/instruments/test_track.py",
    "groundstation/ui/map/plan/test_files.py::test_a_plan_that_is_too_long",
    "groundstation/vehicles/probes/test_stream_requests.py", "groundstation/vehicles/readings/test_outputs.py",
    "groundstation/vehicles/stops/test_foreign_stops.py::test_neutral_flows",
    "groundstation/vehicles/stops/test_foreign_stops.py::test_what_the_driver_sees",
    "groundstation/web/test_server.py", "groundstation/web/test_tab.py",
    "link/protocol/test_channel.py::test_station_takes_files",
    "link/runtime/test_install_hint.py::test_no_other_message", "link/signing/test_key_input.py::test_each_kind",
    "link/signing/test_keys.py::test_a_passphrase", "link/signing/test_verifier.py::test_no_frame",
    "link/test_runner.py::test_the_core_ticks", "test_contact.py",
    "vehicle/autonomy/test_autonomous_stops.py::test_a_lost_position", "vehicle/cli/test_safe_stop.py",
    "vehicle/drive/test_driving.py::test_an_empty_battery", "vehicle/motors/test_sysfs_pwm.py",
    "vehicle/navigation/test_fence.py", "vehicle/runtime/test_lock.py",
    "vehicle/safety/test_pi_monitor.py",
    "vehicle/sim", "vehicle/test_identity.py::test_frames_of_the_former",
    "vehicle/test_identity.py::test_the_driver_is_told", "vehicle/test_safety_texts.py",
    "vehicle/test_stops_in_a_crowd.py",
    "test_flight_monkey.py", "test_flight_stops.py::test_a_copter_heard",
    "test_flight_stops.py::test_a_frozen_station", "test_flight_stops.py::test_a_takeover",
    "test_flight_stops.py::test_disarming", "test_flight_stops.py::test_the_gamepad",
    "test_flight_stops.py::test_the_last_look", "test_obstacle_override.py::test_a_taped_key",
    "test_obstacle_override.py::test_both_ends", "test_stops.py::test_after_a_cut",
    "test_two_links.py::test_a_bad_link", "test_two_links.py::test_a_late_link", "test_two_links.py::test_demands_of",
    "test_two_links.py::test_the_only_sound", "groundstation/station/driving/test_due_times.py::test_a_key_that",
    "groundstation/station/driving/test_due_times.py::test_the_lease",
    "groundstation/station/notes/test_operator_log.py::test_with_the",
    "groundstation/station/test_station.py::test_ticks_are",
    "groundstation/ui/map/plan/test_editor.py::test_no_order",
    "groundstation/vehicles/stops/test_foreign_stops.py::test_disarmed",
    "groundstation/vehicles/stops/test_foreign_stops.py::test_gate",
    "groundstation/vehicles/stops/test_foreign_stops.py::test_quit",
    "groundstation/vehicles/stops/test_px4_checks.py::test_frame_read", "link/protocol/test_channel.py::test_22",
    "link/services/mission/test_files.py::test_what_is", "vehicle/camera/test_scene.py::test_a_wall_is",
    "vehicle/camera/test_scene.py::test_any_pose", "vehicle/drive/test_freshness.py::test_late_commands",
    "vehicle/navigation/test_guidance.py::test_guided_respects",
    "vehicle/proximity/test_obstacles.py::test_a_sensor_that", "vehicle/proximity/test_obstacles.py::test_a_short",
    "vehicle/proximity/test_obstacles.py::test_autonomous", "vehicle/proximity/test_obstacles.py::test_without",
    "vehicle/safety/test_arming.py::test_losing", "vehicle/safety/test_arming.py::test_uploaded",
)  # fmt: skip
"""Folders, files and tests below tests/ that are not in the short suite either: their tests take 0.3 s of CPU or more,
such as the properties that drive a whole rover, test the tests, or need programs and packages that a clone alone
does not have."""

MAIN_JOB = (
    "groundstation/sitl/test_sitl.py::test_sitl_starts",
    "e2e/test_stop_matrix.py::test_key_released", "e2e/test_stop_matrix.py::test_terminal_closed",
    "e2e/test_stop_matrix.py::test_ground_station_killed", "e2e/test_stop_matrix.py::test_ground_station_frozen",
    "e2e/test_stop_matrix.py::test_ground_station_told_to_end", "e2e/test_stop_matrix.py::test_quit_by_key",
    "e2e/test_stop_matrix.py::test_vehicle_told_to_end", "e2e/test_station_process_lost.py::test_our_rover_stops[9",
    "e2e/test_handover.py::test_given_control_stops_the_rover_and_the_other_drives[give",
    "e2e/test_serial_and_bridge.py::test_the_rover_is_driven",
    "e2e/test_serial_and_tcp.py::test_ground_station_killed_or_frozen_with_its_children[serial-9",
    "vehicle/runtime/test_daemon.py::test_a_signal_while_driving",
    "vehicle/safety/test_estop_button.py", "groundstation/verbs/line/test_parser.py",
    "groundstation/verbs/control/test_arm.py::test_it_waits_for_the_pre_arm_bit",
    "groundstation/verbs/control/test_arm.py::test_an_interrupted_arming_disarms",
    "groundstation/verbs/control/test_stops.py::test_disarm_and_stop_are_done",
    "groundstation/verbs/control/test_stops.py::test_a_stop_goes_past",
    "groundstation/verbs/control/test_stops.py::test_without_a_vehicle",
)  # fmt: skip
"""Tests that are in it all the same: starting, driving, every way to die, serial lines, the bridge, and the verbs that
arm and stop."""

ROWS = 1
"""Rows of one parametrised test in the short suite at most, evenly from its table; the others are in the rest."""

APPS = "groundstation/ui"
"""A coroutine below this folder drives the whole program with its screens: 0.1 to 1 s of CPU each."""


def chosen(config: pytest.Config) -> str:
    """Return the suite that was asked for, or that goes with the paths on the command line."""
    named = config.args_source != pytest.Config.ArgsSource.TESTPATHS
    suite: str | None = config.option.suite
    return suite or (ALL if named else SHORT)


def is_long_file(path: Path) -> bool:
    """Return whether a file, or every file of a folder, is not in the short suite, so that it need not be imported."""
    name = _below(path)
    if _is_whole(name, MAIN_JOB) or any(row.startswith((f"{name}/", f"{name}::")) for row in MAIN_JOB):
        return False
    return _is_whole(name, (*LONG, *MARKED))


def is_short(item: pytest.Item) -> bool:
    """Return whether a test is in the short suite."""
    if _is_in(MAIN_JOB, item):
        return True
    if _is_in(LONG, item) or any(mark.name in MARKERS for mark in item.iter_markers()):
        return False
    screens = _below(item.path).startswith(APPS)
    return not (screens and inspect.iscoroutinefunction(getattr(item, "obj", None)))


def split(items: Sequence[pytest.Item], suite: str) -> tuple[list[pytest.Item], list[pytest.Item]]:
    """Return the tests of a suite, and the others."""
    if suite == ALL:
        return list(items), []
    short = set(map(id, thinned([item for item in items if is_short(item)])))
    ours = [(id(item) in short) == (suite == SHORT) for item in items]
    pairs = list(zip(items, ours, strict=True))
    return [item for item, our in pairs if our], [item for item, our in pairs if not our]


def thinned(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Return the items with at most ROWS of each parametrised test, but for those of MAIN_JOB."""
    rows: dict[str, list[pytest.Item]] = {}
    for item in items:
        rows.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept: list[pytest.Item] = []
    for of_one in rows.values():
        kept += of_one if _is_in(MAIN_JOB, of_one[0]) else of_one[:: math.ceil(len(of_one) / ROWS)]
    return kept


def _is_in(rows: tuple[str, ...], item: pytest.Item) -> bool:
    """Return whether one of the rows names the folder, the file or the start of the name of a test."""
    starts = _starts(rows, item.path)
    return starts is None or (bool(starts) and item.nodeid.partition("::")[2].startswith(starts))


@functools.cache  # 11,000 tests are in 500 files
def _starts(rows: tuple[str, ...], path: Path) -> tuple[str, ...] | None:
    """Return how the names of the tests of a file that the rows name begin, or None for all of them."""
    name = _below(path)
    if _is_whole(name, rows):
        return None
    return tuple(row.partition("::")[2] for row in rows if row.startswith(f"{name}::"))


def _is_whole(name: str, rows: Sequence[str]) -> bool:
    """Return whether a row names a folder or file, or a folder above it."""
    return any(name == row or name.startswith(f"{row}/") for row in rows)


def _below(path: Path) -> str:
    return path.relative_to(TESTS).as_posix() if path.is_relative_to(TESTS) else path.as_posix()
