"""The systemd unit: what it promises, and what systemd's own tools think of it."""

from __future__ import annotations

import configparser
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from link.runtime.command_line import USAGE_ERROR
from tests.vehicle.words import said_by
from vehicle.cli.subcommand import SubcommandError
from vehicle.cli.systemd_unit import UnitOptions, build_unit, home_owner

PYTHON = Path(sys.executable)
NOBODYS = UnitOptions(Path("/etc/rover.toml"), Path("/opt/rover/bin/python3"), ("dialout",))
PLACES = {
    "of nobody": UnitOptions(Path("/etc/rover.toml"), PYTHON, ("dialout",)),
    "with power": UnitOptions(Path("/etc/rover.toml"), PYTHON, power=True),
    "in a home": UnitOptions(
        Path("/home/pi/rover.toml"), PYTHON, ("dialout", "video"), user="daemon", driver="sysfs-pwm"
    ),
}

ODD = UnitOptions(Path("/etc/a \\x41 '\" %n $HOME.toml"), PYTHON, ("dialout",))

analysed = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None and "MAVHELM_CI" not in os.environ,
    reason="needs systemd-analyze (Debian: systemd); CI has it",
)


def service(place: UnitOptions) -> dict[str, str]:
    parser = configparser.RawConfigParser(strict=False)
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    parser.read_string(build_unit(place))
    return dict(parser["Service"])


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_it_is_watched_and_restarted_and_its_end_stops_motors(place: UnitOptions) -> None:
    said = service(place)
    assert said["Type"] == "notify"
    assert said["ExecStart"] == f"{PYTHON} -m link.program vehicle --config {place.config}"
    assert said["ExecStopPost"] == f"{PYTHON} -m link.program vehicle safe-stop --config {place.config}"
    assert (said["WatchdogSec"], said["WatchdogSignal"]) == ("1", "SIGKILL")
    assert (said["Restart"], said["RestartSec"]) == ("always", "0.5")
    assert said["StateDirectory"] == "mavhelm"
    assert "StartLimitIntervalSec=0" in build_unit(place)


def test_who_it_runs_as_and_what_it_may_touch() -> None:
    nobody, home = service(NOBODYS), service(PLACES["in a home"])
    assert (nobody["DynamicUser"], nobody["ProtectHome"], nobody["ProtectKernelTunables"]) == ("yes", "yes", "yes")
    assert (home["User"], home["ProtectHome"], home["ProtectKernelTunables"]) == ("daemon", "read-only", "no")
    assert nobody["SupplementaryGroups"] == "dialout"
    assert "SupplementaryGroups" not in service(UnitOptions(Path("/etc/rover.toml")))


def test_a_path_with_odd_characters_is_one_word() -> None:
    place = UnitOptions(Path("/etc/my rover $1 50%.toml"))
    assert service(place)["ExecStart"].endswith('--config "/etc/my rover $$1 50%%.toml"')
    odd = UnitOptions(Path("/etc/a\\x41'\".toml"))
    assert service(odd)["ExecStart"].endswith('--config "/etc/a\\\\x41\'\\".toml"')


def test_the_command_in_its_comment_is_quoted_for_a_shell() -> None:
    unit = build_unit(UnitOptions(Path("/etc/$(touch x) 50%.toml")))
    assert "#   mavhelm vehicle systemd-unit --config '/etc/$(touch x) 50%.toml' | sudo tee" in unit


@pytest.mark.parametrize("name", ["a\nUser=root", "a\rb", "a\x1b[2J"])
def test_a_name_with_control_characters_is_refused(name: str) -> None:
    for options in (UnitOptions(Path(f"/etc/{name}")), UnitOptions(Path("/etc/rover.toml"), user=name)):
        with pytest.raises(SubcommandError, match="control characters"):
            build_unit(options)
    with pytest.raises(SubcommandError, match="not the name of a user"):
        build_unit(UnitOptions(Path("/etc/rover.toml"), user="-o %n"))


def test_the_owner_of_a_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "rover.toml"
    file.touch()
    assert home_owner(file, PYTHON) == home_owner(Path("/etc/rover.toml"), PYTHON)
    monkeypatch.setattr("vehicle.cli.systemd_unit.HOMES", (tmp_path,))
    assert home_owner(file, PYTHON) == file.owner()
    assert home_owner(Path("/etc/rover.toml"), Path("/usr/bin/python3")) is None
    assert home_owner(tmp_path / "none", Path("/usr/bin/python3")) is None


def test_a_home_whose_owner_has_no_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody(path: Path) -> str:
        raise KeyError("getpwuid(): uid not found: 4711")

    monkeypatch.setattr("vehicle.cli.systemd_unit.HOMES", (tmp_path,))
    monkeypatch.setattr(Path, "owner", nobody)
    file = tmp_path / "rover.toml"
    file.touch()
    assert home_owner(file, Path("/usr/bin/python3")) is None


def test_what_is_linked_to_from_elsewhere_may_live_in_a_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The environment is under /opt, and its Python one of pyenv's or uv's."""
    home, elsewhere = tmp_path / "home", tmp_path / "opt"
    for folder in (home, elsewhere):
        folder.mkdir()
    monkeypatch.setattr("vehicle.cli.systemd_unit.HOMES", (home,))
    (home / "python3.11").touch()
    (elsewhere / "python3").symlink_to(home / "python3.11")
    place = UnitOptions(Path("/etc/rover.toml"), elsewhere / "python3")
    assert service(place)["ProtectHome"] == "read-only"
    assert home_owner(place.config, place.python) == (home / "python3.11").owner()


def test_a_mistake_is_the_code_that_ends_the_restarts() -> None:
    assert service(PLACES["of nobody"])["RestartPreventExitStatus"] == str(USAGE_ERROR)


def test_the_computer_follows_the_exit_code_only_where_allowed() -> None:
    assert service(PLACES["of nobody"])["RestartPreventExitStatus"] == "2"
    assert "OnFailure" not in build_unit(PLACES["of nobody"])
    assert service(PLACES["with power"])["RestartPreventExitStatus"] == "2 81 82"
    assert "\nOnFailure=rover-reboot.service rover-poweroff.service\n" in build_unit(PLACES["with power"])


@pytest.mark.parametrize(("word", "code"), [("reboot", 81), ("poweroff", 82)])
def test_the_unit_that_does_it(word: str, code: int, tmp_path: Path) -> None:
    printed, out, error = said_by("systemd-unit", "--power", word)
    assert (printed, error) == (0, "")
    assert f'"$$MONITOR_EXIT_STATUS" != {code} || exec /usr/bin/systemctl --no-block {word}\'\n' in out
    if shutil.which("systemd-analyze"):
        file = tmp_path / f"rover-{word}.service"
        file.write_text(out)
        told = subprocess.run(
            ["systemd-analyze", "verify", str(file)], capture_output=True, text=True, check=False, timeout=60
        )
        assert (told.returncode, file.name in told.stderr) == (0, False)


@pytest.mark.parametrize(
    ("params", "allowed"), [("REBOOT_ENABLE = 2", True), ("REBOOT_ENABLE = 1", False), ("", False)]
)
def test_the_command_sees_what_the_file_allows(tmp_path: Path, params: str, allowed: bool) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(f'[motors]\ndriver = "simulated"\n[params]\n{params}\n')
    assert ("OnFailure" in said_by("systemd-unit", "--config", str(file))[1]) is allowed


@analysed
@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_its_exposure_is_low(place: UnitOptions, tmp_path: Path) -> None:
    file = tmp_path / "rover.service"
    file.write_text(build_unit(place))
    words = ["systemd-analyze", "security", "--offline=true", "--no-pager", str(file)]
    told = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    found = re.search(r"Overall exposure level for \S+: ([\d.]+)", told.stdout)
    assert found, told.stderr
    assert float(found[1]) <= 2.0


@analysed
@pytest.mark.parametrize("place", [*PLACES.values(), ODD], ids=[*PLACES, "with an odd name"])
def test_systemd_understands_every_line(place: UnitOptions, tmp_path: Path) -> None:
    file = tmp_path / "rover.service"
    file.write_text(build_unit(place))
    told = subprocess.run(
        ["systemd-analyze", "verify", str(file)], capture_output=True, text=True, check=False, timeout=60
    )
    assert "rover.service" not in told.stderr
    assert told.returncode == 0


@analysed
def test_the_check_would_see_a_wrong_line(tmp_path: Path) -> None:
    file = tmp_path / "rover.service"
    file.write_text(build_unit(PLACES["of nobody"]).replace("WatchdogSec=1", "WatchdogSek=1"))
    told = subprocess.run(
        ["systemd-analyze", "verify", str(file)], capture_output=True, text=True, check=False, timeout=60
    )
    assert "WatchdogSek" in told.stderr


def test_the_command_prints_it_with_whole_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rover.toml").write_text('[motors]\ndriver = "simulated"\n')
    monkeypatch.chdir(tmp_path)
    code, out, error = said_by("systemd-unit", "--user", "pi")
    assert (code, error) == (0, "")
    assert f"--config {tmp_path}/rover.toml\n" in out
    assert "\nUser=pi\n" in out


def test_without_a_file_it_says_so(tmp_path: Path) -> None:
    code, out, error = said_by("systemd-unit", "--config", str(tmp_path / "none"))
    assert (code, out) == (2, "")
    assert error.endswith("none: No such file or directory\n")
