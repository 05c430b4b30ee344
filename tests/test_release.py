"""A release lists all that it installs, and its checksums can be verified: .ci/release and .ci/sign."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CI = ROOT / ".ci"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
OF_DEVELOPERS = {"test", "interop", "mutation", "fuzz", "pictures", "notebook", "docs", "dev"}
"""Extras that only a checkout has a use for."""
SUMS, SIGNATURE = "SHA256SUMS", "SHA256SUMS.sig"


def listed_extras() -> set[str]:
    [line] = re.findall(r"^EXTRAS=\((.*)\)$", (CI / "release").read_text(), re.MULTILINE)
    return set(line.split())


def constraints() -> dict[str, str]:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    return dict(line.split("==") for line in lines if line and not line.startswith("#"))


MADE_OF_OTHERS = {"all", "desk"}
"""Extras without a package of their own."""


def parts(extra: str) -> set[str]:
    """Return the extras that one is made of."""
    [line] = PROJECT["project"]["optional-dependencies"][extra]
    return set(re.findall(r"^mavhelm\[(.*)\]$", line)[0].split(","))


def test_a_release_lists_the_packages_of_every_extra() -> None:
    """A new extra is either of developers, or made of others, or a scanner must know its packages."""
    extras = PROJECT["project"]["optional-dependencies"].keys()
    assert listed_extras() == extras - OF_DEVELOPERS - MADE_OF_OTHERS


def test_the_extra_all_has_all_but_the_header_of_a_raspberry_pi() -> None:
    assert (parts("all") - {"desk"}) | parts("desk") == listed_extras() - {"pi", "tof"}


def test_the_extra_desk_needs_no_other_network_of_programs() -> None:
    """It is for a person at a screen; ROS and a router on the internet are for fleets."""
    assert parts("desk") == {"bags", "discovery", "gamepad", "keys", "web"}


def test_every_python_of_the_classifiers_may_install_it() -> None:
    classifiers = PROJECT["project"]["classifiers"]
    pythons = [
        each.rpartition(" ")[2] for each in classifiers if each.startswith("Programming Language :: Python :: 3.")
    ]
    assert pythons == ["3.11", "3.12", "3.13", "3.14"]
    assert PROJECT["project"]["requires-python"] == f">={pythons[0]}"


def test_the_build_backend_has_the_version_of_the_constraints() -> None:
    pinned = dict(each.split("==") for each in PROJECT["build-system"]["requires"])
    assert pinned.keys() == {"hatchling", "pymavlink"}
    assert pinned == {name: constraints()[name] for name in pinned}
    assert {"packaging", "pathspec", "pluggy", "trove-classifiers"} <= constraints().keys(), "what hatchling needs"
    assert 'PIP_CONSTRAINT="$PWD/constraints.txt"' in (CI / "release").read_text()


def test_a_release_has_the_time_of_its_commit() -> None:
    """Without it the files in an archive have another time in each build (tests/dialects/test_build.py)."""
    assert 'export SOURCE_DATE_EPOCH="$(git log -1 --format=%ct)"' in (CI / "release").read_text()


def test_the_tools_of_a_release_have_hashes() -> None:
    text = (CI / "release-tools.txt").read_text().replace("\\\n", " ")
    rows = [line for line in text.splitlines() if line and not line.startswith("#")]
    assert {"build", "pip-tools", "cyclonedx-bom"} <= {row.split("==")[0] for row in rows}
    assert all("--hash=sha256:" in row for row in rows)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "dist"
    folder.mkdir()
    (folder / "mavhelm.whl").write_bytes(b"wheel")
    (folder / "requirements.txt").write_bytes(b"msgspec==0.21\n")
    return folder


def sign(folder: Path, *key: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([CI / "sign", folder, *key], capture_output=True, text=True, check=True)


def test_without_a_key_the_checksums_stand_alone_and_it_says_so(folder: Path) -> None:
    assert sign(folder).stderr.startswith("not signed: set RELEASE_KEY")
    assert [line.split("  ")[1] for line in (folder / SUMS).read_text().splitlines()] == [
        "mavhelm.whl",
        "requirements.txt",
    ]
    subprocess.run(["sha256sum", "--check", "--quiet", SUMS], cwd=folder, check=True)


@pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="the program ssh-keygen is missing")
def test_a_signature_holds_for_these_sums_and_this_key_only(folder: Path, tmp_path: Path) -> None:
    """Verified by the line of CONTRIBUTING.md."""
    for name in ("key", "other"):
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", tmp_path / name], check=True)
    (tmp_path / "allowed_signers").write_text("mavhelm " + (tmp_path / "key.pub").read_text())
    [line] = re.findall(r"^ssh-keygen -Y verify .*$", (ROOT / "CONTRIBUTING.md").read_text(), re.MULTILINE)

    def holds() -> bool:
        command = line.replace("allowed_signers", str(tmp_path / "allowed_signers"))
        return subprocess.run(command, shell=True, cwd=folder, capture_output=True, check=False).returncode == 0

    sign(folder, str(tmp_path / "key"))
    assert holds()
    with (folder / SUMS).open("a") as sums:
        sums.write("0" * 64 + "  evil.whl\n")
    assert not holds()
    sign(folder, str(tmp_path / "other"))
    assert not holds()
    sign(folder, str(tmp_path / "key"))
    assert holds()
    sign(folder)
    assert not (folder / SIGNATURE).exists(), "an old signature does not stay beside new checksums"
