"""The folder of a fleet, its certificates and the rules that follow from it."""

from __future__ import annotations

import base64
import re
import ssl
import subprocess
import sys
from pathlib import Path

import pytest

from link.bridge.fleet.access import build_access
from link.bridge.fleet.fleet_command import run
from link.bridge.fleet.fleet_file import read_fleet_file
from link.bridge.fleet.members import FleetError, add_member, new_fleet, renew
from link.bridge.fleet.router_command import run as run_router
from link.endpoint import parse_endpoint
from link.fleet.config import load_config
from link.signing.role import SigningRole
from link.toml.file import TomlError

FILE = """
fleet = "farm"
listen = ["tls/[::]:7447"]
routers = ["tls/fleet.example.org:7447"]
[vehicles.rover1]
certificate = "rover1-1"
[operators.alice]
role = "drive"
certificate = "alice-1"
"""


@pytest.fixture(scope="module")
def farm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fleet of one vehicle and one operator."""
    path = new_fleet(tmp_path_factory.mktemp("fleets") / "farm", "farm", ["fleet.example.org", "10.0.0.1", "::1"])
    add_member(path, "rover1", "vehicle")
    path.write_text(path.read_text() + "\n# my own note\n")
    add_member(path, "alice.b", "drive")
    return path


def test_a_fleet_is_made_and_read(farm: Path) -> None:
    fleet = read_fleet_file(farm)
    assert (fleet.fleet, set(fleet.vehicles), set(fleet.operators)) == ("farm", {"rover1"}, {"alice.b"})
    assert fleet.routers == ["tls/fleet.example.org:7447", "tls/10.0.0.1:7447", "tls/[::1]:7447"]
    assert re.fullmatch(r"alice\.b-[0-9a-f]{8}", fleet.operators["alice.b"].certificate)
    assert "# my own note" in farm.read_text()


def test_keys_are_for_their_user_only(farm: Path) -> None:
    modes = {each.name: each.stat().st_mode & 0o777 for each in farm.parent.iterdir()}
    secret = {name for name in modes if name.endswith((".key", ".json5"))}
    assert secret == {"authority.key", "router.key", "rover1.json5", "alice.b.json5"}
    assert {modes[name] for name in secret} == {0o600}
    assert farm.parent.stat().st_mode & 0o777 == 0o700


def test_the_file_of_a_member_is_all_that_it_needs(farm: Path) -> None:
    config = load_config(parse_endpoint(f"zenoh:{farm.parent}/alice.b.json5/farm"))
    assert (config.name, config.operator_role, config.is_proven) == ("alice.b", SigningRole.DRIVE, True)
    assert list(config.routers) == read_fleet_file(farm).routers


def test_router_certificate_has_its_addresses_and_signs_no_more(farm: Path) -> None:
    ssl.create_default_context(cafile=str(farm.parent / "authority.pem"))
    text = subprocess.run(
        ["openssl", "x509", "-in", str(farm.parent / "router.pem"), "-noout", "-text"],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert "DNS:fleet.example.org, IP Address:10.0.0.1, IP Address:0:0:0:0:0:0:0:1" in text
    assert "TLS Web Server Authentication" in text
    assert "CA:FALSE" in text


@pytest.mark.parametrize("name", ["rover1", "alice.b"])
def test_a_renewed_member_keeps_its_name_and_role(farm: Path, name: str) -> None:
    own, text = farm.parent / f"{name}.json5", farm.read_text()
    before, mode = own.read_text(), own.stat().st_mode
    assert renew(farm, name) == own
    after = own.read_text()
    assert (farm.read_text(), own.stat().st_mode) == (text, mode)

    def told(file: str) -> tuple[list[str], list[str]]:
        whose = re.findall(r'"(?:fleet|name|role)": "(.*)"', file)
        return whose, re.findall(r'"connect_certificate_base64": "(.*)"', file)

    (whose, [old]), (again, [new]) = told(before), told(after)
    assert whose == again
    assert old != new
    subjects = [subject_of(base64.b64decode(each)) for each in (old, new)]
    assert subjects[0] == subjects[1]


def test_a_renewed_router_has_the_same_addresses(farm: Path) -> None:
    before = (farm.parent / "router.pem").read_bytes()
    assert renew(farm, "router") == farm.parent / "router.pem"
    after = (farm.parent / "router.pem").read_bytes()
    assert before != after
    assert names_of(before) == names_of(after)


def test_who_is_no_member_is_not_renewed(farm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        run(["renew", "mallory", "--folder", str(farm.parent)])
    assert ended.value.code == 2
    assert "has no mallory; it has alice.b, rover1" in capsys.readouterr().err


def subject_of(pem: bytes) -> bytes:
    command = ["openssl", "x509", "-noout", "-subject"]
    return subprocess.run(command, input=pem, check=True, capture_output=True).stdout


def names_of(pem: bytes) -> bytes:
    command = ["openssl", "x509", "-noout", "-ext", "subjectAltName"]
    return subprocess.run(command, input=pem, check=True, capture_output=True).stdout


def test_what_exists_is_not_made_again(farm: Path) -> None:
    before = farm.read_text()
    with pytest.raises(FleetError, match="has rover1 already; delete its lines first"):
        add_member(farm, "rover1", "drive")
    with pytest.raises(FleetError, match="exists already; add to it"):
        new_fleet(farm.parent, "farm", ["10.0.0.1"])
    with pytest.raises(FleetError, match="is not a name"):
        add_member(farm, "../x", "vehicle")
    assert farm.read_text() == before


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('role = "drive"', 'role = "drives"', "operators"),
        ("tls/[::]:7447", "tcp/[::]:7447", "listen: 'tcp/[::]:7447' has no certificates; write tls/ or quic/"),
        ("tls/[::]:7447", "7447", "listen: '7447' is not an address; write tls/HOST:PORT"),
        ("alice-1", "rover1-1", "certificate rover1-1 is given twice"),
        ("operators.alice", "operators.rover1", "rover1 is a vehicle and an operator"),
        ("[vehicles.rover1]", '[vehicles."**"]', "'**' is not a name"),
        ("fleet = ", "flet = ", "did you mean fleet?"),
    ],
)
def test_a_mistake_in_the_file_is_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], old: str, new: str, told: str
) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(FILE)
    assert read_fleet_file(path).fleet == "farm"
    path.write_text(FILE.replace(old, new))
    with pytest.raises(TomlError, match=re.escape(told)):
        read_fleet_file(path)
    with pytest.raises(SystemExit) as ended:
        run_router([str(path)])
    assert ended.value.code == 2
    assert len(capfd.readouterr().err.splitlines()) == 1


def test_who_may_publish_and_hear_what(tmp_path: Path) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(FILE)
    access = build_access(read_fleet_file(path))
    assert access["default_permission"] == "deny"
    allowed = {
        (rule["id"].split()[0], message): rule["key_exprs"]
        for rule in access["rules"]
        for message in rule["messages"]
        if rule["flows"] == ["ingress"]
    }
    down = "fleet/farm/*/down/alice/*"
    assert allowed["alice-1", "put"] == [f"{down}/watch/**", f"{down}/drive/**"]
    assert allowed["alice-1", "declare_subscriber"] == ["fleet/farm/*/up/alice/**"]
    assert allowed["rover1-1", "put"] == ["fleet/farm/rover1/up/**"]
    assert allowed["rover1-1", "declare_subscriber"] == ["fleet/farm/rover1/down/**"]
    assert not any("declare_queryable" in rule["messages"] for rule in access["rules"])
    assert allowed["router", "put"] == ["fleet/farm/**"], "a linked router has checked it"


def test_a_link_to_another_router_has_certificates(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "fleet.toml"
    path.write_text(FILE)
    with pytest.raises(SystemExit) as ended:
        run_router([str(path), "--link", "tcp/10.0.0.2:7447"])
    assert ended.value.code == 2
    assert "--link: 'tcp/10.0.0.2:7447' has no certificates" in capfd.readouterr().err


def test_the_commands_say_what_to_do_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["new", "farm", "--host", "10.0.0.1"]) == 0
    assert "mavhelm bridge router farm/fleet.toml" in capsys.readouterr().out
    assert run(["add", "operator", "bob", "--role", "watch", "--folder", "farm"]) == 0
    assert "there: mavhelm zenoh:bob.json5/farm" in capsys.readouterr().out
    for wrong, told in (
        (["new", "farm", "--host", "10.0.0.1"], "exists already"),
        (["new", "barn", "--host", "a/b"], "--host: 'tls/a/b:7447' is not an address"),
        (["add", "vehicle", "rover1"], "fleet.toml: No such file or directory"),
        (["add", "operator", "carl", "--role", "boss"], "choose from"),
    ):
        with pytest.raises(SystemExit) as ended:
            run(wrong)
        assert ended.value.code == 2
        said = capsys.readouterr().err
        assert told in said
        assert len(said.splitlines()) == 1


def test_a_port_that_is_taken_is_named(farm: Path) -> None:
    import socket

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        own = farm.parent / "taken.toml"
        own.write_text(farm.read_text().replace("tls/[::]:7447", f"tls/127.0.0.1:{taken.getsockname()[1]}", 1))
        done = subprocess.run(
            [sys.executable, "-m", "link.bridge", "router", str(own)],
            capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert "the port is in use" in done.stderr
    assert len(done.stderr.splitlines()) == 1
