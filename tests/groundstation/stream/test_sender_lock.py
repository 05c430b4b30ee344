"""Whose packets are pictures: in virtual time, and with real sockets at the process that receives them."""

from __future__ import annotations

import socket
import time
from contextlib import ExitStack, suppress

import pytest

from groundstation.stream.orders import StreamOrders
from groundstation.stream.receiver_link import ReceiverLink
from groundstation.stream.sender_lock import SILENT_AFTER, SenderLock, choose_senders, clean_host
from tests.groundstation.stream.streams import packets, unit_of
from tests.ports import free_port
from tests.waits import wait_until

ROVER, OTHER = "10.0.0.5", "10.0.0.9"


def test_the_first_sender_keeps_the_port_until_it_is_silent() -> None:
    lock = SenderLock()
    assert lock.passes(ROVER, 1.0)
    assert not lock.passes(OTHER, 1.1)
    assert lock.complaint(1.2) == ""
    assert lock.passes(ROVER, 1.3)
    assert lock.passes(OTHER, 1.4 + SILENT_AFTER)
    assert not lock.passes(ROVER, 1.5 + SILENT_AFTER)
    assert lock.complaint(1.5 + 3 * SILENT_AFTER) == "", "no sender was given from which it could have come"


def test_only_the_vehicle_may_send_where_its_address_is_known() -> None:
    lock = SenderLock(choose_senders([ROVER, "fe80::1%eth0"]))
    assert lock.passes(f"::ffff:{ROVER}", 1.0)
    assert lock.passes("fe80::1%wlan0", 1.0)
    assert not lock.passes(OTHER, 1.0 + 10 * SILENT_AFTER)
    complaint = lock.complaint(1.0 + 10 * SILENT_AFTER)
    assert complaint.startswith(f"pictures come from {OTHER}, not from the vehicle at 10.0.0.5 or fe80::1")
    assert lock.passes(ROVER, 50.0)
    assert lock.complaint(50.0 + 2 * SILENT_AFTER) == ""


@pytest.mark.parametrize("hosts", [[], ["127.0.0.1"], ["::1", ROVER], ["router"]])
def test_a_vehicle_behind_this_machine_may_be_anywhere(hosts: list[str]) -> None:
    assert choose_senders(hosts) == ()


def test_addresses_are_compared_as_numbers() -> None:
    assert clean_host("::FFFF:10.0.0.5") == "10.0.0.5"
    assert clean_host("FE80:0::1%3") == "fe80::1"
    assert clean_host("a name") == "a name"


@pytest.mark.e2e
def test_pictures_of_a_stranger_reach_no_screen() -> None:
    with ExitStack() as stack:
        link = ReceiverLink(1)
        stack.callback(link.close)
        sockets = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(3)]
        screen, rover, stranger = sockets
        for each, host in ((screen, "127.0.0.1"), (rover, "127.0.0.1"), (stranger, "127.0.0.2")):
            each.bind((host, 0))
        screen.setblocking(False)
        orders = StreamOrders(free_port(), (screen.getsockname()[1],))
        seen: set[int] = set()
        number = 0

        def send(*senders: socket.socket) -> None:
            """Each sends a picture of its own size, and the screen reads what comes."""
            nonlocal number
            link.update(orders, time.monotonic())
            for each in senders:
                for packet in packets(unit_of(number, key=True, size=300 if each is rover else 600), number, 0):
                    each.sendto(packet, ("127.0.0.1", orders.port))
                    number += 1
            with suppress(BlockingIOError):
                while True:
                    seen.add(len(screen.recv(65536)) > 500)

        wait_until(lambda: seen, each=lambda: send(rover))
        for _ in range(200):
            send(rover, stranger)
        assert seen == {False}
        wait_until(lambda: True in seen, each=lambda: send(stranger))  # the rover is silent
        orders = StreamOrders(orders.port, orders.screens, senders=("127.0.0.3",))
        refused = "127.0.0.2, not from the vehicle at 127.0.0.3"
        wait_until(lambda: refused in link.report.problem, each=lambda: send(stranger))
