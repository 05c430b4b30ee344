"""The command line: what is understood, and what one line says about what is not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from link.signing.key_file import FILE
from link.transport.faults.settings import FaultSettings
from vehicle.cli.main import main
from vehicle.cli.options import GROUND_STATION
from vehicle.config.run_settings import RunSettings, Simulation
from vehicle.runtime import daemon
from vehicle.sensors.gps import GpsSettings
from vehicle.sensors.suite import SensorSettings


def settings_of(monkeypatch: pytest.MonkeyPatch, *words: str) -> RunSettings:
    """What the daemon is given for these words."""
    given: list[RunSettings] = []

    def run(settings: RunSettings) -> int:
        given.append(settings)
        return 0

    monkeypatch.setattr(daemon, "run", run)
    assert main(words) == 0
    return given[0]


def test_the_simulator_needs_one_word(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = settings_of(monkeypatch, "--sim")
    assert settings.endpoints == (GROUND_STATION,)
    assert settings.simulation == Simulation()
    assert settings.params == {"FS_LOOP_TIMEOUT": 1.0}


@pytest.mark.parametrize(
    "words", [("--sim", "udpout:10.0.0.1:1"), ("udpout:10.0.0.1:1", "--sim"), ("--sim", "udpout://10.0.0.1:1/")]
)
def test_an_endpoint_may_stand_anywhere(monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]) -> None:
    assert settings_of(monkeypatch, *words).endpoints == ("udpout:10.0.0.1:1",)


def test_everything_a_simulation_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    words = "--sim --system 7 --home -33.5,151.25 --sim-battery 0.3 --sim-seed 5 --sim-truth t"
    words += " --loss 20 --delay 200 --jitter 50 --cut 3 --walls w"
    settings = settings_of(monkeypatch, *words.split(), *["--motor-log", "m", "--param", "speed_max=3"])
    assert settings.simulation is not None
    assert settings.simulation.home[:2] == (-33.5, 151.25)
    assert (settings.simulation.battery, settings.simulation.seed, settings.simulation.truth) == (0.3, 5, "t")
    assert settings.simulation.walls == "w"
    assert settings.simulation.faults == FaultSettings(loss=0.2, delay=0.2, jitter=0.05, cut=3.0, seed=5)
    assert settings.params == {"FS_LOOP_TIMEOUT": 1.0, "SPEED_MAX": 3.0}
    assert settings.pinned == {"MAV_SYSID": 7}
    assert settings.motor_log == "m"


def test_a_real_vehicle_keeps_the_tight_loop_timeout(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = settings_of(monkeypatch, "udpin:0.0.0.0:14550", "--motors", "car:Motors", "udpout:10.0.0.1:1")
    assert settings.simulation is None
    assert settings.motors == {"driver": "car:Motors"}
    assert settings.params == {}
    assert settings.endpoints == ("udpin:0.0.0.0:14550", "udpout:10.0.0.1:1")


def test_the_user_may_tighten_the_loop_timeout_of_a_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    assert settings_of(monkeypatch, "--sim", "--param", "FS_LOOP_TIMEOUT=0.2").params == {"FS_LOOP_TIMEOUT": 0.2}


RIG = """
endpoints = ["udpin:127.0.0.1:1"]
[identity]
system = 3
[motors]
driver = "roboclaw"
port = "/dev/serial0"
[sensors.gps]
port = 3000
[params]
MAN_TIMEOUT = 0.3
[log]
motors = "moves"
"""


def test_a_file_says_everything(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    settings = settings_of(monkeypatch, "--config", str(tmp_path / "rig.toml"))
    assert settings.endpoints == ("udpin:127.0.0.1:1",)
    assert settings.motors == {"driver": "roboclaw", "port": "/dev/serial0"}
    assert settings.sensors == SensorSettings(gps=GpsSettings(port=3000))
    assert settings.pinned == {"MAN_TIMEOUT": 0.3, "MAV_SYSID": 3}
    assert (settings.params, settings.motor_log, settings.simulation) == ({}, "moves", None)


def test_options_win_over_the_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    words = "udpout:10.0.0.1:2 --system 9 --motors simulated --param MAN_TIMEOUT=0.4 --motor-log m"
    settings = settings_of(monkeypatch, "--config", str(tmp_path / "rig.toml"), *words.split())
    assert settings.endpoints == ("udpout:10.0.0.1:2",)
    assert settings.motors == {"driver": "simulated"}
    assert settings.pinned == {"MAN_TIMEOUT": 0.3, "MAV_SYSID": 9}
    assert (settings.params, settings.motor_log) == ({"MAN_TIMEOUT": 0.4}, "m")


def test_a_file_can_be_tried_in_the_simulator(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(RIG)
    settings = settings_of(monkeypatch, "--sim", "--config", str(tmp_path / "rig.toml"))
    assert settings.simulation is not None
    assert settings.endpoints == ("udpin:127.0.0.1:1",)
    assert settings.params == {"FS_LOOP_TIMEOUT": 1.0}


def test_a_mistake_in_the_file_is_one_line_and_code_2(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "rig.toml"
    file.write_text(RIG.replace("port", "prot"))
    with pytest.raises(SystemExit) as ended:
        main(["--config", str(file)])
    assert ended.value.code == 2
    assert capsys.readouterr().err == (
        f"mavhelm vehicle: {file}: motors.prot: unknown key; did you mean port? "
        "(and 2 more; see `mavhelm vehicle check`)\n"
    )


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("udpout:127.0.0.1:14550", "no motors: use --config FILE or --motors NAME for real ones, or --sim"),
        ("--motors simulated", "no endpoint"),
        ("--sim --motors simulated", "--sim has its own motors"),
        ("--motors simulated udpout:127.0.0.1:1 --home 1,2", "--home is for --sim only"),
        ("--motors simulated udpout:127.0.0.1:1 --sim-battery 0.5", "--sim-battery is for --sim only"),
        ("--sim udpot:127.0.0.1:14550", "did you mean udpout:127.0.0.1:14550?"),
        ("--sim udpout:127.0.0.1", "udpout:HOST:PORT"),
        ("--sim udpout:127.0.0.1:99999", "port '99999' is not a number from 1 to 65535"),
        ("--sim --system 0", "'0' is not a number from 1 to 255"),
        ("--sim --system x", "'x' is not a number from 1 to 255"),
        ("--sim --param MAN_TIMOUT=1", "unknown parameter 'MAN_TIMOUT'; did you mean MAN_TIMEOUT"),
        ("--sim --param zebra=1", "unknown parameter 'ZEBRA'; `mavhelm vehicle dialect` lists all"),
        ("--sim --param MAN_TIMEOUT=99", "MAN_TIMEOUT must be 0.2 to 2, not 99"),
        ("--sim --param MAN_TIMEOUT=nan", "MAN_TIMEOUT must be"),
        ("--sim --param MAN_TIMEOUT=soon", "MAN_TIMEOUT: 'soon' is not a number; write MAN_TIMEOUT=VALUE"),
        ("--sim --param MAN_TIMEOUT", "MAN_TIMEOUT: '' is not a number"),
        ("--sim --home here", "'here' is not LAT,LON"),
        ("--sim --home 91,0", "'91,0' is not LAT,LON"),
        ("--sim --home nan,0", "'nan,0' is not LAT,LON"),
        ("--sim --sim-battery 2", "'2' is not a charge from 0 to 1"),
        ("--sim --sim-seed x", "invalid int value: 'x'"),
        ("--motors simulated udpout:127.0.0.1:1 --loss 20", "--loss is for --sim only"),
        ("--motors simulated udpout:127.0.0.1:1 --cut 3", "--cut is for --sim only"),
        ("--sim --loss 120", "'120' is not a loss in percent from 0 to 100"),
        ("--sim --delay soon", "'soon' is not a delay in ms from 0 to 60000"),
        ("--sim --jitter nan", "'nan' is not a jitter in ms from 0 to 60000"),
        ("--sim --cut 0", "'0' is not a time in s from 0.1 to 3600"),
        ("--sim zenoh:tcp/127.0.0.1:7447/farm/one --loss 5", "do not work on zenoh:tcp/127.0.0.1:7447/farm/one"),
        ("--sim --log-file /no/such/folder/log", "log file /no/such/folder/log: No such file or directory"),
        ("--simm", "unknown option --simm; did you mean --sim?"),
        ("--sim --parm SPEED_MAX=3", "unknown option --parm; did you mean --param?"),
        ("--sim --xyzzy=3", "unknown option --xyzzy ("),
        ("--sim --home", "expected one argument"),
    ],
)
def test_a_mistake_is_one_line_and_code_2(capsys: pytest.CaptureFixture[str], words: str, says: str) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words.split())
    out, err = capsys.readouterr()
    assert ended.value.code == 2
    assert out == ""
    assert says in err
    assert err.startswith("mavhelm vehicle: ")
    assert err.count("\n") == 1


def test_no_words_teach(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "mavhelm vehicle --sim" in capsys.readouterr().err


def test_help_teaches_with_examples(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    out = capsys.readouterr().out
    for word in ("examples:", "udpout:HOST:PORT", "MODULE:CLASS", "--param", "exit codes:"):
        assert word in out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("mavhelm vehicle ")


def test_help_does_not_import_the_daemon() -> None:
    """So that it, and a mistake, answer at once."""
    script = "import sys, vehicle.__main__; sys.exit('asyncio' in sys.modules or 'dialects.rover' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_a_simulation_says_which_keys_it_leaves_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("STATE_DIRECTORY", str(tmp_path))
    (tmp_path / FILE).write_text("")
    settings_of(monkeypatch, "--sim")
    assert f"keys in {tmp_path / FILE} are not used: a simulation without --state has none" in caplog.text
    caplog.clear()
    settings_of(monkeypatch, "--sim", "--state", str(tmp_path))
    assert "are not used" not in caplog.text
