"""What is said where multicast DNS is not to be had."""

from __future__ import annotations

import re
import sys

import pytest

from link.discovery.mdns import Announcer, Browser, DiscoveryError
from link.discovery.service import MavlinkService
from link.endpoint import parse_endpoint
from link.runtime.install_hint import install_command

ROVER = MavlinkService("Rover 1", "", 0)


def test_a_missing_library_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zeroconf", None)
    browser = Browser()
    browser.open()
    assert browser.problem.endswith(install_command("discovery"))
    assert browser.services == ()
    browser.close()
    with pytest.raises(DiscoveryError, match=re.escape(install_command("discovery"))):
        Announcer([parse_endpoint("udpin:127.0.0.1:14550")], ROVER)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # the library leaves its socket open
def test_an_address_of_another_machine_cannot_be_announced() -> None:
    pytest.importorskip("zeroconf")
    with pytest.raises(DiscoveryError, match=re.escape("udpin:192.0.2.1:14550")):
        Announcer([parse_endpoint("udpin:192.0.2.1:14550")], ROVER)


def test_endpoints_that_connect_are_not_announced() -> None:
    assert Announcer([parse_endpoint("udpout:192.0.2.1:14550")], ROVER).count == 0
