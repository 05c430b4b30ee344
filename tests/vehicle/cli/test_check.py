"""`mavhelm vehicle check`: one line for each item, nothing moves, and the code says where the fault is."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.ports import free_port
from tests.vehicle.motors.across_processes import NAME, FiledPca9685
from tests.vehicle.motors.controllers import RoboClaw, Sabertooth
from tests.vehicle.motors.pty_controller import OnPty
from tests.vehicle.sensors.ranging.frames import Line, tfmini_frame
from tests.vehicle.words import said_by
from vehicle.cli.check import run_checks
from vehicle.config.template import build_template
from vehicle.storage.param_store import encode

FREE = 'endpoints = ["udpout:127.0.0.1:9"]\n'
QUIET = "[sensors]\ncomputer = false\n"
KEEPS = ("ok    parameters: ", "ok    state: ", "ok    log.tlog: ")
USUAL = ("saved in FOLDER", "FOLDER is writable", "FOLDER/logs can be created")


def checked(folder: Path, text: str) -> tuple[int, list[str]]:
    """The exit code and the lines, without those of parameters and folders where they are as usual."""
    code, lines = all_checked(folder, text)
    return code, [line for line in lines if not (line.startswith(KEEPS) and line.endswith(USUAL))]


def all_checked(folder: Path, text: str, *words: str) -> tuple[int, list[str]]:
    file = folder / "rover.toml"
    file.write_text(text)
    state = () if "--state" in words else ("--state", str(folder))
    code, out, error = said_by("check", str(file), *state, *words)
    assert error == ""
    return code, [line.replace(str(file), "FILE").replace(str(folder), "FOLDER") for line in out.splitlines()]


@pytest.fixture
def line() -> Iterator[OnPty]:
    with OnPty(RoboClaw()) as opened:
        yield opened


def test_the_sample_is_well_as_it_is(tmp_path: Path) -> None:
    port = free_port()
    code, lines = checked(tmp_path, build_template().replace("0.0.0.0:14550", f"127.0.0.1:{port}"))
    assert code == 0
    assert lines[:3] == [
        "ok    settings: FILE",
        f"ok    endpoint udpin:127.0.0.1:{port}: opens",
        "ok    motors: simulated with 2 motors, neutral and without power",
    ]
    assert lines[3].startswith("ok    sensors.computer: ")


def test_every_mistake_in_the_file_has_its_line(tmp_path: Path) -> None:
    code, lines = checked(tmp_path, "endpont = 1\n[params]\nMAN_TIMEOUT = 9\n")
    assert code == 2
    assert lines == [
        "FAIL  settings: FILE: endpont: unknown key; did you mean endpoints?",
        "FAIL  settings: FILE: params.MAN_TIMEOUT: must be 0.2 to 2, not 9",
    ]


def test_a_file_that_lacks_the_main_things(tmp_path: Path) -> None:
    code, lines = checked(tmp_path, QUIET)
    assert code == 2
    assert [each.split(": ")[0] for each in lines] == ["ok    settings", "FAIL  endpoints", "FAIL  motors"]


def test_a_controller_answers_and_no_wheel_turns(line: OnPty, tmp_path: Path) -> None:
    text = f'{FREE}[motors]\ndriver = "roboclaw"\nport = "{line.path}"\nreply_time = 0.05\n{QUIET}'
    code, lines = checked(tmp_path, text)
    assert code == 0
    assert lines[-1] == (
        "ok    motors: roboclaw with 2 motors, neutral and without power; version USB Roboclaw 2x7a v4.2.8"
    )
    assert line.controller.outputs == [0.0, 0.0]


def test_a_timeout_that_nobody_has_proven_is_found(tmp_path: Path) -> None:
    with OnPty(Sabertooth()) as line:
        text = f'{FREE}[motors]\ndriver = "sabertooth"\nport = "{line.path}"\nsafety = {{}}\n{QUIET}'
        code, lines = checked(tmp_path, text)
        assert code == 1
        assert "its timeout cannot be read back: pull its signal wire with the wheels in the air" in lines[-1]
        assert line.controller.outputs == [0.0, 0.0]


def test_motors_that_turned_stand_after_it(tmp_path: Path) -> None:
    chip = FiledPca9685(tmp_path / "registers")
    chip.write_byte_data(0x40, 0xFE, 121)  # 50 Hz, as the file says
    chip.write_byte_data(0x40, 0, 0x20)
    chip.write_i2c_block_data(0x40, 6, [0, 0, 0x99, 0x01])
    assert chip.pulse(0) == pytest.approx(2e-3, abs=5e-6)
    words = f'driver = "{NAME}:Pca9685"\nregisters = "{tmp_path / "registers"}"'
    channels = "channels = [{channel = 0}, {channel = 1}]"
    code, _ = checked(tmp_path, f"{FREE}[motors]\n{words}\n{channels}\n{QUIET}")
    assert code == 0
    assert chip.pulse(0) == pytest.approx(1.5e-3, abs=5e-6)
    assert chip.pulse(1) is None  # that gave no pulses, and was not woken


def test_missing_hardware_is_a_fault_and_the_rest_is_tried(tmp_path: Path) -> None:
    text = (
        'endpoints = ["serial:/dev/no-such-port:57600", "udpout:127.0.0.1:9"]\n'
        '[motors]\ndriver = "roboclaw"\nport = "/dev/nowhere"\n'
        '[sensors]\ncomputer = false\n[sensors.battery]\nkind = "ina219"\nbus = 99\n'
    )
    code, lines = checked(tmp_path, text)
    assert code == 1
    assert [each[:4] for each in lines] == ["ok  ", "FAIL", "ok  ", "FAIL", "FAIL"]
    assert "/dev/no-such-port" in lines[1]
    assert "/dev/nowhere" in lines[3]
    assert "sensors.battery: ina219 at 0x40 on I2C bus 99" in lines[4]


def test_an_unwritable_log_is_found_before_the_vehicle_starts(tmp_path: Path) -> None:
    log = f'{FREE}{QUIET}[motors]\ndriver = "simulated"\n[log]\n'
    text = f'{log}file = "{tmp_path}/none/log"\nmotors = "{tmp_path}/motors"\n'
    code, lines = checked(tmp_path, text)
    assert (code, lines[-2:]) == (1, [
        "FAIL  log.file: no folder FOLDER/none; create it",
        "ok    log.motors: FOLDER/motors is writable",
    ])  # fmt: skip
    assert not (tmp_path / "motors").exists()
    code, lines = checked(tmp_path, f'{log}file = "{tmp_path}"\n')
    assert (code, lines[-1]) == (1, "FAIL  log.file: FOLDER is a folder")


def test_unwritable_folders_are_found_before_the_vehicle_starts(tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    text = f'{FREE}{QUIET}[motors]\ndriver = "simulated"\n'
    code, lines = all_checked(tmp_path, text, "--state", str(tmp_path / "taken"))
    told = "FOLDER/taken is not a folder; remove it, or set another folder with"
    assert code == 1
    assert lines[2:4] == [f"FAIL  state: {told} state or --state", f"FAIL  log.tlog: {told} log.tlog"]
    code, lines = checked(tmp_path, f'{text}[log]\ntlog = "{tmp_path}/taken/logs"\n')
    assert (code, lines[1]) == (1, f"FAIL  log.tlog: {told} log.tlog")
    assert checked(tmp_path, f'{text}[log]\ntlog = "{tmp_path}/taken/logs"\n[params]\nLOG_BACKEND_TYPE = 0\n')[0] == 0
    assert not (tmp_path / "logs").exists()  # who checks makes nothing, it would be his


def test_a_port_in_use_and_the_wrong_number_of_motors(tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        text = (
            f'endpoints = ["udpin:127.0.0.1:{port}"]\n[motors]\ndriver = "simulated"\n{QUIET}[params]\nDRIVE_TYPE = 4\n'
        )
        code, lines = checked(tmp_path, text)
    assert code == 1
    assert f"port {port} is in use" in lines[1]
    assert lines[2] == "FAIL  motors: the driver has 2 motors, DRIVE_TYPE 4 needs 4"


def test_a_connection_is_tried(tmp_path: Path) -> None:
    text = f'{QUIET}[motors]\ndriver = "simulated"\n'
    with socket.create_server(("127.0.0.1", 0)) as listener:
        endpoint = f"tcpout:127.0.0.1:{listener.getsockname()[1]}"
        code, lines = checked(tmp_path, f'endpoints = ["{endpoint}"]\n{text}')
        assert (code, lines[1]) == (0, f"ok    endpoint {endpoint}: connects")
    code, lines = checked(tmp_path, f'endpoints = ["{endpoint}"]\n{text}')
    assert (code, lines[1]) == (1, f"FAIL  endpoint {endpoint}: not connected (Connection refused)")


@pytest.mark.parametrize(
    ("report", "says"),
    [
        (b'{"class":"TPV","mode":3,"lat":48.1,"lon":11.5}\n', "ok    sensors.gps: fix type 3, 0 satellites"),
        (b"", "FAIL  sensors.gps: gpsd at 127.0.0.1:"),
    ],
)
def test_gpsd_is_asked(tmp_path: Path, report: bytes, says: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            client, _ = server.accept()
            with client:
                client.recv(1000)
                client.sendall(report)
                if report:
                    client.recv(1000)

        thread = threading.Thread(target=serve)
        thread.start()
        port = server.getsockname()[1]
        text = f'{FREE}[motors]\ndriver = "simulated"\n[sensors]\ncomputer = false\n[sensors.gps]\nport = {port}\n'
        code, lines = checked(tmp_path, text)
        thread.join(10)
    assert lines[-1].startswith(says)
    assert code == (0 if report else 1)


def test_without_a_file_it_says_how_to_get_one(tmp_path: Path) -> None:
    code, out, _ = said_by("check", str(tmp_path / "rover.toml"))
    assert code == 2
    assert "`mavhelm vehicle init" in out


def test_it_reckons_with_the_parameters_that_the_vehicle_keeps(tmp_path: Path) -> None:
    text = f'{FREE}[motors]\ndriver = "simulated"\n{QUIET}[params]\nMOT2_REVERSED = 1\nMOT1_MAX = 50\n'
    code, lines = all_checked(tmp_path, text)
    assert code == 0
    assert lines[1] == "ok    parameters: 2 from the file, 0 saved in FOLDER"
    assert lines[-1] == "ok    motors: simulated with 2 motors, neutral and without power; reversed: right"
    (tmp_path / "parameters").write_bytes(encode({"MOT1_REVERSED": 1.0, "MOT2_REVERSED": 0.0, "MOT1_MIN": 60.0}))
    code, lines = all_checked(tmp_path, text)
    assert code == 1
    assert lines[1] == (
        "FAIL  parameters: 2 from the file, 1 saved in FOLDER: "
        "a saved one is not used: MOT1_MIN 60 must be smaller than MOT1_MAX 50"
    )
    assert lines[-1].endswith("; reversed: left, right")


def test_kept_parameters_that_are_damaged_are_a_fault(tmp_path: Path) -> None:
    (tmp_path / "parameters").write_bytes(b"half a fi")
    text = f'{FREE}state = "{tmp_path}"\n[motors]\ndriver = "simulated"\n{QUIET}'
    code, lines = all_checked(tmp_path, text)
    assert code == 1
    damaged = "parameter file damaged; start the vehicle and set a parameter from a ground station to repair it"
    assert lines[1] == f"FAIL  parameters: 0 from the file, 0 saved in FOLDER: {damaged}"
    assert all_checked(tmp_path, text, "--state", "/nowhere")[1][1].endswith("0 saved in /nowhere")


def test_each_mistake_of_a_section_is_named(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text('endpoints = ["udpin:127.0.0.1:14550"]\n[motors]\ndriver = "gpio"\nbackwards = [1, 2]\npwm = "x"\n'
                    '[sensors.battery]\naddress = "high"\nshunt_ohm = true\n')  # fmt: skip
    problems = [result.detail for result in run_checks(str(file)) if not result.ok]
    named = [problem.partition(": ")[2].partition(": ")[0] for problem in problems]
    assert len(named) == len(set(named)) >= 4, problems
    assert {"motors.backwards", "motors.pwm", "sensors.battery.address"} <= set(named)


def test_range_sensors_are_measured_or_say_why_not(tmp_path: Path) -> None:
    with Line(lambda: tfmini_frame(150)) as line:
        ranges = "".join(
            f'[[sensors.rangefinders]]\ndriver = "tfmini"\nnumber = {number}\nport = "{port}"\n'
            for number, port in ((1, line.path), (2, "/dev/nowhere"))
        )
        code, lines = checked(tmp_path, f'{FREE}[motors]\ndriver = "simulated"\n{QUIET}{ranges}')
    assert code == 1
    assert lines[-2] == "ok    sensors.rangefinders[0]: RNGFND1: nearest obstacle 1.50 m"
    assert lines[-1].startswith("FAIL  sensors.rangefinders[1]: /dev/nowhere")
