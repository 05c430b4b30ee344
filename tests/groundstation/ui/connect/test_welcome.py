"""The head of the Connect screen."""

from __future__ import annotations

import msgspec

from groundstation.ui.connect.welcome import Welcome, WelcomeValue
from tests.groundstation.ui.frames import texts

VALUE = WelcomeValue("listening", addresses=("192.168.4.20", "10.0.0.7", "10.8.0.1", "172.17.0.1"))


def welcome(value: WelcomeValue) -> str:
    return "\n".join(texts(Welcome(value).draw(140, 15)))


def test_a_vehicle_is_told_the_addresses_of_this_machine() -> None:
    shown = welcome(VALUE)
    assert "this machine         192.168.4.20  10.0.0.7  10.8.0.1\n" in shown.replace(" \n", "\n")
    assert "mavhelm vehicle --config rover.toml udpout:192.168.4.20:14550" in shown
    assert "send to 192.168.4.20:14550" in shown


def test_without_an_address_it_says_what_to_do() -> None:
    shown = welcome(msgspec.structs.replace(VALUE, addresses=()))
    assert "this machine         no address yet: connect it to the network of the vehicle" in shown
    assert "udpout:ADDRESS:14550" in shown


def test_in_wsl_it_says_what_comes_before_a_link() -> None:
    assert "WSL" not in welcome(VALUE)
    shown = welcome(msgspec.structs.replace(VALUE, wsl=True))
    assert "in WSL, before that  UDP: networkingMode=mirrored; USB: usbipd; docs/windows.md" in shown
    assert "mavhelm --help" in shown, "nothing falls off the end"
