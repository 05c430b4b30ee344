"""The systems that a package is made for, and what pip calls them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Suite:
    """A release of Debian: its default Python, and what versions of packages for it end with."""

    python: str
    suffix: str


SUITES = {"trixie": Suite("3.13", "deb13"), "bookworm": Suite("3.11", "deb12")}
MACHINES = {"amd64": "x86_64", "arm64": "aarch64"}
"""Debian's name of a processor -> the kernel's, also in the names of wheels."""
GLIBC = ("2_36", "2_35", "2_34", "2_31", "2_28", "2_27", "2_26", "2_24", "2_17", "2_12", "2_5")
"""Versions of the C library that a wheel may ask for: bookworm has 2.36."""
OLD_NAMES = ("manylinux2014", "manylinux2010", "manylinux1")
"""Names of 2.17, 2.12 and 2.5; the last two are for x86_64 only."""


@dataclass(frozen=True, slots=True)
class DebTarget:
    """A release of Debian on a kind of processor."""

    suite: str
    architecture: str

    @property
    def python(self) -> str:
        """Return the version of its Python, as 3.13."""
        return SUITES[self.suite].python

    @property
    def next_python(self) -> str:
        """Return the version whose modules lie in another folder."""
        major, minor = self.python.split(".")
        return f"{major}.{int(minor) + 1}"

    @property
    def platforms(self) -> tuple[str, ...]:
        """Return the tags of wheels that run there, the newest C library first."""
        machine = MACHINES[self.architecture]
        old = OLD_NAMES if machine == "x86_64" else OLD_NAMES[:1]
        return (*(f"manylinux_{glibc}_{machine}" for glibc in GLIBC), *(f"{name}_{machine}" for name in old))

    @property
    def environment(self) -> dict[str, str]:
        """Return the values of the markers in requirements there, such as python_version."""
        return {
            "implementation_name": "cpython",
            "implementation_version": f"{self.python}.0",
            "os_name": "posix",
            "platform_machine": MACHINES[self.architecture],
            "platform_release": "",
            "platform_version": "",
            "platform_python_implementation": "CPython",
            "platform_system": "Linux",
            "python_full_version": f"{self.python}.0",
            "python_version": self.python,
            "sys_platform": "linux",
        }

    def version(self, upstream: str, revision: int) -> str:
        """Return the version of the package, with a suffix: the packages of two suites are not the same."""
        return f"{upstream}-{revision}~{SUITES[self.suite].suffix}"
