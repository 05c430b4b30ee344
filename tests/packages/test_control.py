"""The control files of the Debian package: programs, unit, settings, licences, scripts."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from email.parser import Parser
from pathlib import Path

import pytest
from deb import control, tree
from deb.target import DebTarget

from link.runtime import install_hint
from vehicle.cli.systemd_unit import HARDWARE_GROUPS, UnitOptions, build_unit
from vehicle.config.template import build_template

ROOT = Path(__file__).parents[2]
SCRIPTS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
ENTRY_POINTS = "[console_scripts]\n" + "".join(f"{name} = {place}\n" for name, place in SCRIPTS.items())
TRIXIE = DebTarget("trixie", "arm64")


def test_every_program_is_started_by_the_private_python() -> None:
    launchers = tree.launchers(ENTRY_POINTS)
    assert launchers.keys() == SCRIPTS.keys()
    assert all(text.startswith("#!/usr/lib/mavhelm/bin/python3 -P\n") for text in launchers.values())
    assert "from vehicle.__main__ import main\n" in launchers["vehicle"]


def test_bridge_is_never_a_program_of_the_system(tmp_path: Path) -> None:
    tree._link_programs(tmp_path / "usr/lib/mavhelm", tmp_path / "usr/bin", ENTRY_POINTS)
    assert {each.name for each in (tmp_path / "usr/bin").iterdir()} == SCRIPTS.keys() - {"bridge"}
    assert (tmp_path / "usr/bin/vehicle").readlink() == Path("../lib/mavhelm/bin/vehicle")


def test_the_messages_of_the_programs_know_the_folder() -> None:
    assert Path(control.FOLDER) == install_hint.SYSTEM_FOLDER


def test_the_unit_runs_as_its_user_with_the_conffile() -> None:
    text = build_unit(
        UnitOptions(Path(control.CONFIG), Path("/usr/lib/mavhelm/bin/python3"), tree.GROUPS, control.USER)
    )
    unit = control.unit(text)
    [command] = re.findall(r"^ExecStart=(.*)$", unit, re.M)
    assert command.startswith("/usr/lib/mavhelm/bin/python3 -m ")
    assert command.endswith(" vehicle --config /etc/mavhelm/rover.toml")
    assert "User=mavhelm\nSupplementaryGroups=dialout gpio i2c video\n" in unit
    assert "/etc/systemd/system" not in unit


def test_every_group_of_the_unit_is_made_or_debians() -> None:
    assert tree.GROUPS == HARDWARE_GROUPS
    rows = [line.split() for line in (tree.HERE / "files/sysusers.conf").read_text().splitlines()]
    made = {row[1] for row in rows if row[0] == "g"} | {"dialout", "video"}  # base-passwd has these two
    assert set(tree.GROUPS) <= made
    assert {row[2] for row in rows if row[0] == "m"} == set(tree.GROUPS)


def test_the_settings_name_the_folder_of_the_service() -> None:
    settings = tomllib.loads(control.config(build_template()))
    assert settings["state"] == control.STATE
    assert settings["motors"] == {"driver": "simulated"}
    with pytest.raises(ValueError, match="no line"):
        control.config("")


def test_the_package_is_for_one_python_only() -> None:
    fields = Parser().parsestr(control.control(TRIXIE, "0.1.0-1", 12))
    assert "python3 (>= 3.13~), python3 (<< 3.14~)" in fields["Depends"]
    assert fields["Architecture"] == "arm64"
    suggested = {each.strip() for each in fields["Suggests"].split(",")}
    assert set(install_hint.SYSTEM_PACKAGES.values()) <= suggested


@pytest.mark.skipif(shutil.which("dpkg") is None, reason="the program dpkg is missing")
def test_a_version_of_an_older_suite_is_lower() -> None:
    older, newer = (DebTarget(suite, "amd64").version("0.1.0", 1) for suite in ("bookworm", "trixie"))
    subprocess.run(["dpkg", "--compare-versions", older, "lt", newer], check=True)


@pytest.mark.parametrize("name", control.scripts())
def test_a_script_of_the_package_is_valid_shell(name: str) -> None:
    subprocess.run(["sh", "-n"], input=control.scripts()[name], text=True, check=True)


def test_licences_are_one_word_and_name_their_text() -> None:
    rows = [
        "Name: a-b\nVersion: 1\nLicense: BSD 3-Clause",
        "Name: c\nVersion: 2\nClassifier: License :: OSI Approved :: MIT",
    ]
    text = control.copyright_file(map(Parser().parsestr, rows))
    assert re.findall(r"^License: (.*)$", text, re.M) == ["Apache-2.0", "BSD-3-Clause", "MIT"]
    assert "site-packages/a_b*\n" in text


@pytest.mark.skipif(shutil.which("desktop-file-validate") is None, reason="desktop-file-validate is missing")
def test_the_desktop_file_is_valid() -> None:
    checked = subprocess.run(
        ["desktop-file-validate", ROOT / "packaging/mavhelm.desktop"], capture_output=True, text=True, check=False
    )
    assert (checked.returncode, checked.stdout) == (0, "")


def test_the_package_has_every_file_that_it_names() -> None:
    assert [source for source in tree.PLACED if not (tree.HERE / source).is_file()] == []
