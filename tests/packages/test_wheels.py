"""The Debian package has the wheels that its target needs, and of each the files that are used."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from email.message import Message
from email.parser import Parser

import pytest
from deb.target import MACHINES, SUITES, DebTarget
from deb.wheels import LEFT_OUT, collect, kept_files
from packaging.tags import cpython_tags
from packaging.utils import NormalizedName

TRIXIE = DebTarget("trixie", "arm64")


def metadata(name: str, *requirements: str) -> Message:
    return Parser().parsestr(f"Name: {name}\n" + "".join(f"Requires-Dist: {each}\n" for each in requirements))


def collected(packages: dict[str, Message], target: DebTarget = TRIXIE) -> Sequence[str]:
    """Return what the first package needs; each one is fetched once."""
    fetched: list[str] = []

    def fetch(names: Collection[NormalizedName]) -> Callable[[NormalizedName], Message]:
        assert not set(names) & set(fetched)
        fetched.extend(names)
        return packages.__getitem__

    return collect(packages["mavhelm"], target.environment, fetch)


def test_extras_of_extras_and_their_packages_are_found() -> None:
    packages = {
        "mavhelm": metadata("mavhelm", "a>=1", 'mavhelm[w]; extra == "all"', 'b; extra == "w"', 'c; extra == "dev"'),
        "a": metadata("a", "B_b", "d[x]"), "b": metadata("b"), "b-b": metadata("B_b"),
        "d": metadata("d", 'e; extra == "x"', 'f; extra == "y"'), "e": metadata("e", "a"),
    }  # fmt: skip
    assert collected(packages) == ["a", "b", "b-b", "d", "e"]


def test_an_extra_that_is_wanted_later_adds_its_packages() -> None:
    packages = {
        "mavhelm": metadata("mavhelm", "a", "b"), "a": metadata("a", 'c; extra == "x"'), "b": metadata("b", "a[x]"),
        "c": metadata("c"),
    }  # fmt: skip
    assert collected(packages) == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("marker", "target", "needed"),
    [
        ("python_version < '3.14'", TRIXIE, True),
        ("python_version < '3.13'", TRIXIE, False),
        ("python_version < '3.13'", DebTarget("bookworm", "amd64"), True),
        ("platform_machine == 'x86_64'", TRIXIE, False),
        ("platform_machine == 'x86_64'", DebTarget("trixie", "amd64"), True),
        ("platform_system == 'Linux'", TRIXIE, True),
        ("sys_platform == 'win32'", TRIXIE, False),
    ],
)
def test_markers_are_those_of_the_target(marker: str, target: DebTarget, needed: bool) -> None:
    packages = {"mavhelm": metadata("mavhelm", f"a; {marker}"), "a": metadata("a")}
    assert collected(packages, target) == (["a"] if needed else [])


def test_what_debian_brings_is_left_out() -> None:
    assert collected({"mavhelm": metadata("mavhelm", *LEFT_OUT)}) == []


@pytest.mark.parametrize(("architecture", "machine"), MACHINES.items())
def test_every_tag_is_one_that_pip_knows(architecture: str, machine: str) -> None:
    platforms = DebTarget("trixie", architecture).platforms
    assert all(each.endswith(f"_{machine}") for each in platforms)
    tags = {str(tag) for tag in cpython_tags((3, 13), platforms=platforms)}
    assert f"cp313-cp313-manylinux_2_17_{machine}" in tags
    assert f"cp39-abi3-manylinux2014_{machine}" in tags


@pytest.mark.parametrize("suite", SUITES)
def test_the_next_python_is_another_folder(suite: str) -> None:
    target = DebTarget(suite, "amd64")
    assert int(target.next_python.split(".")[1]) == int(target.python.split(".")[1]) + 1


def test_scripts_byte_code_and_records_are_not_unpacked() -> None:
    files = [
        "a/__init__.py",
        "a/__pycache__/b.pyc",
        "a-1.data/scripts/a",
        "a-1.dist-info/RECORD",
        "a-1.dist-info/METADATA",
    ]
    assert kept_files("a", files) == ["a/__init__.py", "a-1.dist-info/METADATA"]


def test_of_pymavlink_the_definitions_are_kept() -> None:
    files = ["pymavlink/__init__.py", "pymavlink/mavutil.py", "pymavlink/dialects/v20/common.py"]
    definitions = ["pymavlink/dialects/v20/common.xml", "pymavlink-2.4.dist-info/licenses/COPYING"]
    assert kept_files("pymavlink", [*files, *definitions]) == [files[0], *definitions]
