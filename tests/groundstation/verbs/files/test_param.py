"""`mavhelm param` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.params import Param, many_params
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.waits import Waits

Capture = pytest.CaptureFixture[str]


def some_params() -> dict[str, Param]:
    return {
        "FS_ACTION": Param(2, 2, 1),
        "FS_TIMEOUT": Param(1.5),
        "INS_GYR_ID": Param(-1234567, 6),
        "RC_OPTIONS": Param(32, 6, 0),
        "STAT_BOOTCNT": Param(7, 4, read_only=True),
    }


@pytest.fixture(params=[ARDUPILOT, PX4], ids=["ardupilot", "px4"])
def vehicle(request: pytest.FixtureRequest) -> Iterator[ForeignVehicle]:
    with foreign_vehicle(request.param) as running:
        running.params.replace(some_params())
        yield running


def param(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, "param", *arguments, "-e", vehicle.endpoint, "-v", "1")


def test_get_by_pattern_and_by_name(capsys: Capture, vehicle: ForeignVehicle) -> None:
    found = param(capsys, vehicle, "get", "fs_*")
    defaults = "  # default 1" if vehicle.autopilot == ARDUPILOT else ""
    assert (found.code, found.out) == (0, f"FS_ACTION        2{defaults}\nFS_TIMEOUT       1.5\n")
    assert (
        param(capsys, vehicle, "get", "ins_gyr_id", "FS_TIMEOUT").out
        == "INS_GYR_ID       -1234567\nFS_TIMEOUT       1.5\n"
    )
    assert param(capsys, vehicle, "get", "RC_OPTIONS", "--json").records == [
        {"param_id": "RC_OPTIONS", "param_value": 32.0, "param_type": "INT32", "default": None}
    ]


def test_all_come_in_order_as_a_file_or_as_a_list(capsys: Capture, vehicle: ForeignVehicle) -> None:
    got = param(capsys, vehicle, "get")
    assert [line.split()[0] for line in got.out.splitlines()] == sorted(vehicle.params)
    lists, files = len(vehicle.of("PARAM_REQUEST_LIST")), len(vehicle.of("FILE_TRANSFER_PROTOCOL"))
    assert (lists, files > 2) == ((0, True) if vehicle.autopilot == ARDUPILOT else (1, False))


def test_set_is_confirmed_by_the_vehicle(capsys: Capture, vehicle: ForeignVehicle) -> None:
    done = param(capsys, vehicle, "set", "FS_ACTION", "1")
    assert (done.code, done.out) == (0, "FS_ACTION 1 (was 2)\n")
    assert vehicle.params["FS_ACTION"].value == 1
    done = param(capsys, vehicle, "set", "ins_gyr_id", "0x10", "--json")
    assert done.records[0] | {"took": 0} == {
        "ok": True, "verb": "param set", "vehicle": 1, "param_id": "INS_GYR_ID", "param_value": 16.0,
        "detail": "was -1234567", "text": "", "took": 0,
    }  # fmt: skip
    assert vehicle.params["INS_GYR_ID"].value == 16


def test_a_refusal_has_the_vehicles_own_words(capsys: Capture, vehicle: ForeignVehicle) -> None:
    refused = param(capsys, vehicle, "set", "STAT_BOOTCNT", "0")
    assert refused.code == ExitCode.REFUSED
    assert refused.err.endswith('set STAT_BOOTCNT to 0: refused, the vehicle keeps 7, "STAT_BOOTCNT is read-only"\n')
    assert vehicle.params["STAT_BOOTCNT"].value == 7


@pytest.mark.parametrize(
    ("value", "words"), [("1.7", "its type INT8 cannot hold 1.7"), ("200", "its type INT8 cannot hold 200")]
)
def test_what_the_type_cannot_hold_is_not_sent(
    capsys: Capture, vehicle: ForeignVehicle, value: str, words: str
) -> None:
    refused = param(capsys, vehicle, "set", "FS_ACTION", value)
    assert refused.code == ExitCode.USAGE
    assert words in refused.err
    assert vehicle.of("PARAM_SET") == []


@pytest.mark.parametrize("words", [("get", "FS_ACTON"), ("set", "FS_ACTON", "1")])
def test_a_name_that_the_list_lacks_is_named_soon(
    capsys: Capture, vehicle: ForeignVehicle, words: tuple[str, ...]
) -> None:
    unknown = param(capsys, vehicle, *words)
    assert (unknown.code, unknown.out) == (ExitCode.DIFFERS, "")
    assert unknown.err.endswith("it has no FS_ACTON: did you mean FS_ACTION?\n")
    assert len(vehicle.of("PARAM_REQUEST_READ")) < 8
    assert vehicle.of("PARAM_SET") == []


def test_an_unanswered_name_ends_with_the_number_of_tries(capsys: Capture, vehicle: ForeignVehicle) -> None:
    vehicle.params.withheld.add("FS_ACTION")
    unanswered = param(capsys, vehicle, "get", "FS_ACTION")
    if vehicle.autopilot == PX4:
        assert (unanswered.code, unanswered.out) == (ExitCode.NO_ANSWER, "")
        assert unanswered.err.splitlines()[-1].endswith("read FS_ACTION: no answer, after 8 tries")
    else:  # the file of parameters has it
        assert "FS_ACTION" in unanswered.err + unanswered.out


def test_save_diff_and_load(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file = str(tmp_path / "a.param")
    assert param(capsys, vehicle, "save", file).code == 0
    assert param(capsys, vehicle, "diff", file).code == 0
    vehicle.params["FS_TIMEOUT"].value, vehicle.params["RC_OPTIONS"].value = 3.0, 64.0
    differing = param(capsys, vehicle, "diff", file)
    assert (differing.code, differing.out) == (
        ExitCode.DIFFERS,
        "FS_TIMEOUT       1.5          here 3\nRC_OPTIONS       32           here 64\n",
    )
    dry = param(capsys, vehicle, "load", file, "--dry-run")
    assert (dry.code, dry.out) == (
        ExitCode.DIFFERS,
        "FS_TIMEOUT       3 -> 1.5\nRC_OPTIONS       64 -> 32\n",
    )
    assert vehicle.of("PARAM_SET") == []
    loaded = param(capsys, vehicle, "load", file)
    assert (loaded.code, loaded.out) == (0, dry.out)
    assert (vehicle.params["FS_TIMEOUT"].value, vehicle.params["RC_OPTIONS"].value) == (1.5, 32)


def test_a_read_only_value_stops_no_other_of_a_file(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file = tmp_path / "a.param"
    file.write_text("FS_ACTION 1\nSTAT_BOOTCNT 0\nRC_OPTIONS 1\n")
    loaded = param(capsys, vehicle, "load", str(file))
    assert loaded.code == ExitCode.PARTLY
    assert loaded.out == "FS_ACTION        2 -> 1\nRC_OPTIONS       32 -> 1\n"
    assert '"STAT_BOOTCNT is read-only"' in loaded.err
    assert "2 parameters set; kept by the vehicle: STAT_BOOTCNT" in loaded.err
    assert vehicle.params["RC_OPTIONS"].value == 1


def test_what_the_type_cannot_hold_ends_a_load(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file = tmp_path / "a.param"
    file.write_text("FS_TIMEOUT 2\nFS_ACTION 1.5\nRC_OPTIONS 1\n")
    loaded = param(capsys, vehicle, "load", str(file))
    assert loaded.code == ExitCode.PARTLY
    assert "1 of 3 are set; not tried: RC_OPTIONS" in loaded.err
    assert vehicle.params["RC_OPTIONS"].value == 32


def test_the_id_of_a_vehicle_is_not_loaded_from_a_file(
    capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path
) -> None:
    vehicle.params.update({"SYSID_THISMAV": Param(1, 3, 1), "MAV_SYS_ID": Param(1, 6), "MAV_SYSID": Param(1, 1, 2)})
    file = tmp_path / "other.param"
    file.write_text("SYSID_THISMAV 2\nMAV_SYS_ID 2\nMAV_SYSID 2\nFS_ACTION 1\n")
    loaded = param(capsys, vehicle, "load", str(file))
    assert (loaded.code, loaded.out) == (0, "FS_ACTION        2 -> 1\n")
    assert "left out, as each vehicle has its own: SYSID_THISMAV, MAV_SYS_ID, MAV_SYSID" in loaded.err
    assert {vehicle.params[name].value for name in ("SYSID_THISMAV", "MAV_SYS_ID", "MAV_SYSID")} == {1}
    if vehicle.autopilot == ARDUPILOT:
        assert param(capsys, vehicle, "save", str(file), "--changed", "--yes").code == 0
        assert "MAV_SYSID" not in file.read_text(), "an id is not a setting that was changed"


def test_a_file_of_another_vehicle_names_what_is_not_here(
    capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path
) -> None:
    file = tmp_path / "a.param"
    file.write_text("FS_ACTION 1\nFENCE_RADIUS 300\n")
    assert "FENCE_RADIUS     not on the vehicle\n" in param(capsys, vehicle, "diff", str(file)).out
    loaded = param(capsys, vehicle, "load", str(file))
    assert loaded.code == ExitCode.PARTLY
    assert "not on the vehicle: FENCE_RADIUS" in loaded.err
    assert vehicle.params["FS_ACTION"].value == 1


def test_changed_saves_what_is_not_at_its_default(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file = tmp_path / "a.param"
    saved = param(capsys, vehicle, "save", str(file), "--changed", "--format", "qgc")
    if vehicle.autopilot == PX4:
        assert saved.code == ExitCode.REFUSED
        assert "does not report defaults" in saved.err
    else:
        assert file.read_text().splitlines()[3:] == ["1\t1\tFS_ACTION\t2\t2", "1\t1\tRC_OPTIONS\t32\t6"]


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_a_thousand_parameters_over_a_lossy_list(capsys: Capture, autopilot: int) -> None:
    with foreign_vehicle(autopilot, loss=0.05, ftp=False) as vehicle:
        vehicle.params.replace(dict(many_params(1200)))
        got = param(capsys, vehicle, "get", "--json")
        assert got.code == 0, got.err
        values = {record["param_id"]: record["param_value"] for record in got.records}
        assert values == pytest.approx({name: each.value for name, each in vehicle.params.items()}, rel=1e-6)


def test_integers_of_px4_are_exact(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.params.replace({"A": Param(2_000_000_001, 6), "B": Param(-1, 6), "C": Param(4e9 + 7, 5)})
        assert param(capsys, vehicle, "get").out.split() == ["A", "2000000001", "B", "-1", "C", "4000000007"]
        assert param(capsys, vehicle, "set", "A", "-2000000001").code == 0
        assert vehicle.params["A"].value == -2_000_000_001


@pytest.mark.parametrize("ftp", [False, True])
def test_whole_numbers_of_ardupilot_keep_their_digits(capsys: Capture, tmp_path: Path, ftp: bool) -> None:
    with foreign_vehicle(ARDUPILOT, ftp=ftp) as vehicle:
        vehicle.params.replace({"OWN_STAT": Param(287454016, 6), "OWN_SERIAL": Param(-2147483648, 6)})
        assert param(capsys, vehicle, "get").out.split() == ["OWN_SERIAL", "-2147483648", "OWN_STAT", "287454016"]
        assert param(capsys, vehicle, "get", "OWN_STAT", "--json").records[0]["param_value"] == 287454016
        file = tmp_path / "own.parm"
        assert param(capsys, vehicle, "save", str(file)).code == 0
        assert [line.split() for line in file.read_text().splitlines()] == [
            ["OWN_SERIAL", "-2147483648.000000"], ["OWN_STAT", "287454016.000000"],
        ]  # fmt: skip
        same = param(capsys, vehicle, "set", "OWN_SERIAL", "-2147483648")
        assert (same.code, same.out) == (0, "OWN_SERIAL -2147483648 (was -2147483648)\n")


def test_a_whole_number_that_float32_changes_is_not_sent(capsys: Capture) -> None:
    with foreign_vehicle(ARDUPILOT) as vehicle:
        vehicle.params.replace({"OWN_OPTIONS": Param(1, 6), "OWN_FLOAT": Param(1.0)})
        refused = param(capsys, vehicle, "set", "OWN_OPTIONS", "1073741825")
        assert refused.code == ExitCode.USAGE
        assert "float32 carries 1073741824 or 1073741952, not 1073741825" in refused.err
        below = param(capsys, vehicle, "set", "OWN_OPTIONS", "-16777217")
        assert "float32 carries -16777218 or -16777216, not -16777217" in below.err
        assert vehicle.of("PARAM_SET") == []
        assert param(capsys, vehicle, "set", "OWN_OPTIONS", "0x40000000").code == 0
        assert vehicle.params["OWN_OPTIONS"].value == 1073741824
        rounded = param(capsys, vehicle, "set", "OWN_FLOAT", "16777217")
        assert (rounded.code, rounded.out) == (0, "OWN_FLOAT 16777216 (was 1)\n")


def test_load_names_the_whole_numbers_that_it_cannot_set(capsys: Capture, tmp_path: Path) -> None:
    file = tmp_path / "own.parm"
    file.write_text("OWN_OPTIONS 1073741825\nOWN_RATE 4\n")
    with foreign_vehicle(ARDUPILOT) as vehicle:
        vehicle.params.replace({"OWN_OPTIONS": Param(1073741824, 6), "OWN_RATE": Param(2.0)})
        assert "OWN_OPTIONS      1073741825   here 1073741824" in param(capsys, vehicle, "diff", str(file)).out
        loaded = param(capsys, vehicle, "load", str(file))
        assert (loaded.code, loaded.out) == (ExitCode.PARTLY, "OWN_RATE         2 -> 4\n")
        assert "float32 does not carry all digits of the file: OWN_OPTIONS" in loaded.err
        assert (vehicle.params["OWN_OPTIONS"].value, vehicle.params["OWN_RATE"].value) == (1073741824, 4)


def test_a_value_that_the_list_may_have_rounded_is_no_difference(capsys: Capture, tmp_path: Path) -> None:
    file = tmp_path / "own.parm"
    file.write_text("OWN_STAT 287454020\n")
    with foreign_vehicle(ARDUPILOT, ftp=False) as vehicle:
        vehicle.params.replace({"OWN_STAT": Param(287454020, 6)})
        assert param(capsys, vehicle, "diff", str(file)).code == 0


def test_px4_integers_that_float32_joins_are_different(capsys: Capture, tmp_path: Path) -> None:
    file = tmp_path / "own.parm"
    file.write_text("A 1073741825\n")
    with foreign_vehicle(PX4) as vehicle:
        vehicle.params.replace({"A": Param(1073741824, 6)})
        assert param(capsys, vehicle, "load", str(file)).out == "A                1073741824 -> 1073741825\n"
        assert vehicle.params["A"].value == 1073741825


def test_save_names_parameters_without_a_value(capsys: Capture, tmp_path: Path) -> None:
    file = tmp_path / "own.params"
    with foreign_vehicle(PX4) as vehicle:
        vehicle.params.replace({"OWN_GAIN": Param(0.5), "OWN_UNSET": Param(float("nan")), "OWN_RATE": Param(2.5)})
        saved = param(capsys, vehicle, "save", str(file), "--format", "mavproxy")
        assert saved.code == ExitCode.PARTLY
        assert "2 parameters of" in saved.err
        assert saved.err.endswith(f"saved to {file}; left out, no number: OWN_UNSET\n")
        assert [line.split()[0] for line in file.read_text().splitlines()] == ["OWN_GAIN", "OWN_RATE"]


def test_a_list_with_a_hole_is_printed_and_the_hole_named(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.params.replace({name: Param(1.0) for name in ("A", "B", "C")})
        vehicle.silent.add(20)  # PARAM_REQUEST_READ
        vehicle.params.withheld.add("B")
        got = param(capsys, vehicle, "get")
        assert got.code == ExitCode.PARTLY
        assert [line.split()[0] for line in got.out.splitlines()] == ["A", "C"]
        assert "1 of 3 parameters missing after 8 tries" in got.err
        saved = param(capsys, vehicle, "save", "/tmp/never.param", "--yes")
        assert saved.code == ExitCode.NO_ANSWER
        assert "nothing was changed or written" in saved.err


def test_a_vehicle_without_parameters(capsys: Capture) -> None:
    with foreign_vehicle(PX4, ftp=False) as vehicle:
        vehicle.silent |= {20, 21, 76}
        got = param(capsys, vehicle, "get")
        assert got.code == ExitCode.NO_ANSWER
        assert "fetch parameters: no answer, no list after 8 tries" in got.err


def test_two_vehicles_need_a_choice_before_a_change(capsys: Capture) -> None:
    with foreign_vehicle(ARDUPILOT) as one, foreign_vehicle(ARDUPILOT, system=2) as two:
        for each in (one, two):
            each.params |= some_params()
        both = ["-e", one.endpoint, "-e", two.endpoint]
        chosen = run_verb(capsys, "param", "set", "FS_ACTION", "1", *both)
        assert chosen.code == ExitCode.USAGE
        assert "vehicles 1, 2 are here: choose one with --vehicle" in chosen.err
        assert one.params["FS_ACTION"].value == two.params["FS_ACTION"].value == 2


def test_no_vehicle_and_the_wrong_vehicle(capsys: Capture, vehicle: ForeignVehicle) -> None:
    waits, started = Waits(), time.monotonic()
    none = run_verb(capsys, "param", "get", "-e", "udpout:127.0.0.1:9", "--wait", "0.3")
    assert none.code == ExitCode.NO_VEHICLE
    lacks = "mavhelm: no vehicle on udpout:127.0.0.1:9 within 0.3 s: "
    assert none.err.startswith((f"{lacks}refused: nothing listens there", f"{lacks}no answer; a vehicle must "))
    assert time.monotonic() - started < 5 + waits.total()
    other = run_verb(capsys, "param", "get", "-e", vehicle.endpoint, "-v", "7", "--wait", "2")
    assert (other.code, other.out) == (ExitCode.NO_VEHICLE, "")
    assert "no vehicle 7" in other.err
    assert "but 1" in other.err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["get", "-e", "carrier:pigeon"], "udpin:HOST:PORT"),
        (["set", "A", "nan", "-e", "udpout:127.0.0.1:9"], "'nan' is not a number that a parameter can have"),
        (["set", "A"], "VALUE"),
        (["fly"], "invalid choice: 'fly'"),
        ([], "ACTION"),
        (["get", "--wait", "-1"], "'-1' is not a number of seconds above 0"),
        (["get", "-v", "256"], "'256' is not a number from 1 to 255"),
        (["get", "-e", ""], "-e has nothing behind it"),
    ],
)
def test_mistakes_are_one_line(capsys: Capture, arguments: list[str], words: str) -> None:
    run = run_verb(capsys, "param", *arguments)
    assert (run.code, run.out) == (ExitCode.USAGE, "")
    assert run.err.count("\n") == 1
    assert words in run.err


def test_files_that_cannot_be_read_or_written(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    existing = tmp_path / "a.param"
    existing.write_bytes(b"\xff\xfe\x00")
    twice = tmp_path / "b.param"
    twice.write_text("A 1\nA 2\n")
    for arguments, words in (
        (["diff", str(tmp_path / "none")], "No such file or directory"),
        (["diff", str(existing)], "this is not a text file"),
        (["load", str(twice)], "b.param:2: A is given twice, first in line 1: remove one"),
        (["save", str(existing)], "exists already; --yes overwrites it"),
        (["save", str(tmp_path)], "this is a folder; name a file"),
        (["save", str(tmp_path / "x" / "y")], "there is no folder"),
    ):
        run = param(capsys, vehicle, *arguments)
        assert run.code == ExitCode.USAGE, run.err
        assert words in run.err
        assert run.err.count("\n") == 1


def test_store_and_reset_are_commands_and_reset_wants_yes(capsys: Capture, vehicle: ForeignVehicle) -> None:
    stored, each = param(capsys, vehicle, "store"), ": ArduPilot stores each parameter when it is set"
    why = each if vehicle.autopilot == ARDUPILOT else ""
    assert (stored.code, stored.err) == (0, f"mavhelm: {_name(vehicle)} has stored its parameters{why}\n")
    refused = param(capsys, vehicle, "reset")
    assert refused.code == ExitCode.USAGE
    assert refused.err.endswith("this resets ALL parameters of the vehicle; --yes does it\n")
    vehicle.answers[245] = (4, "Disarm first")
    refused = param(capsys, vehicle, "reset", "--yes")
    assert refused.code == ExitCode.REFUSED
    assert 'reset the parameters: refused, FAILED, "Disarm first"' in refused.err
    sent = [(each.param1, each.param2) for each in vehicle.of("COMMAND_LONG") if each.command == 245]
    store = [] if vehicle.autopilot == ARDUPILOT else [(1.0, -1.0)]
    assert sent == [*store, (2.0, -1.0)], "plans are left alone"


def _name(vehicle: ForeignVehicle) -> str:
    return "ArduPilot rover 1" if vehicle.autopilot == ARDUPILOT else "PX4 rover 1"
