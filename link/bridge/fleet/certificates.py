"""Certificates of a fleet, made with the openssl program: an authority, and one certificate for each member."""

from __future__ import annotations

import ipaddress
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import msgspec

DAYS = 3650
"""Days that a certificate holds. A rover must not stop on a birthday; fleet.toml withdraws one at any time, and from 90
days before the end its owner is warned (link/fleet/validity.py)."""
NOT_FOUND = "openssl is not installed: sudo apt install openssl"


class CertificateError(Exception):
    """A certificate could not be made; one line."""


class KeyPair(msgspec.Struct, frozen=True):
    """A certificate and its private key, as PEM. The text form never contains the key."""

    certificate: bytes
    key: bytes

    def __repr__(self) -> str:
        return "KeyPair(...)"


def make_authority(fleet: str) -> KeyPair:
    """Return a new authority. Raises CertificateError."""
    with tempfile.TemporaryDirectory() as folder:
        usage = ("basicConstraints=critical,CA:TRUE,pathlen:0", "keyUsage=critical,keyCertSign,cRLSign")
        extensions = [part for each in usage for part in ("-addext", each)]
        subject = f"/CN={fleet} authority"
        _openssl(folder, "req", "-x509", *_new_key("own"), "-subj", subject, *extensions, "-days", str(DAYS),
                 "-out", "own.pem")  # fmt: skip
        return _read_pair(Path(folder))


def make_member(common_name: str, authority: KeyPair, hosts: Sequence[str] = ()) -> KeyPair:
    """Return a certificate that the authority has signed. `hosts`: of a router, where it is reached."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "authority.pem").write_bytes(authority.certificate)
        (place / "own.cnf").write_text(_extensions(hosts))
        _openssl(folder, "req", "-new", *_new_key("own"), "-subj", f"/CN={common_name}", "-out", "own.csr")
        _openssl(
            folder,
            "x509",
            "-req",
            "-in",
            "own.csr",
            "-CA",
            "authority.pem",
            "-CAkey",
            "/dev/stdin",  # a copy in a file would stay behind if this program were killed
            "-sha256",
            "-CAcreateserial",
            "-days",
            str(DAYS),
            "-extfile",
            "own.cnf",
            "-out",
            "own.pem",
            given=authority.key,
        )
        return _read_pair(place)


def _new_key(name: str) -> tuple[str, ...]:
    return ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-keyout", f"{name}.key")


def _extensions(hosts: Sequence[str]) -> str:
    lines = ["basicConstraints=critical,CA:FALSE", "keyUsage=critical,digitalSignature"]
    usage = "serverAuth,clientAuth" if hosts else "clientAuth"  # a router also connects to other routers
    lines.append(f"extendedKeyUsage={usage}")
    if hosts:
        lines.append("subjectAltName=" + ",".join(f"{'IP' if _is_address(each) else 'DNS'}:{each}" for each in hosts))
    return "\n".join(lines) + "\n"


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def _read_pair(folder: Path) -> KeyPair:
    return KeyPair((folder / "own.pem").read_bytes(), (folder / "own.key").read_bytes())


def _openssl(folder: str, *arguments: str, given: bytes = b"") -> None:
    try:
        done = subprocess.run(["openssl", *arguments], cwd=folder, input=given, capture_output=True, check=False)
    except FileNotFoundError:
        raise CertificateError(NOT_FOUND) from None
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or ["no reason given"]
        raise CertificateError(f"openssl {arguments[0]}: {lines[-1]}")
