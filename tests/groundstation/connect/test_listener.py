"""Vehicles are heard on the usual ports, and not a byte is sent there."""

from __future__ import annotations

import asyncio
import socket

from groundstation.connect.listener import VehicleListener
from groundstation.views.connect import HeardRow
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.ports import free_port
from tests.waits import until

IDS = (255, 190)


async def heard(listener: VehicleListener, count: int) -> tuple[HeardRow, ...]:
    loop = asyncio.get_running_loop()
    await until(lambda: len(listener.heard(loop.time())) == count)
    return listener.heard(loop.time())


async def test_a_vehicle_is_heard_and_hears_nothing() -> None:
    here, there = (f"udpin:127.0.0.1:{free_port()}" for _ in range(2))
    listener = VehicleListener(IDS, (here, there))
    listener.listen(())
    assert [row.endpoint for row in listener.listening] == [here, there]
    with on_line(FakeVehicle(), endpoint=here) as one, on_line(FakeVehicle(system=7), endpoint=there) as other:
        first, second = sorted(await heard(listener, 2), key=lambda row: row.system)
        assert (first.name, first.mode, first.armed, first.endpoint) == ("Rover 1", "MANUAL", False, here)
        assert (second.system, second.endpoint, second.open) == (7, there, False)
        assert one.received == other.received == []
    listener.close()
    assert not listener.listening


async def test_the_port_of_a_link_of_ours_is_left_alone_and_free() -> None:
    port = free_port()
    listener = VehicleListener(IDS, (f"udpin:127.0.0.1:{port}",))
    listener.listen(())
    listener.listen({port})
    assert not listener.listening
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.bind(("127.0.0.1", port))
        listener.listen(())
        assert ["is in use" in row.problem for row in listener.listening] == [True]
    listener.listen(())
    assert [row.problem for row in listener.listening] == [""]
    listener.close()


async def test_a_flood_of_system_ids_and_of_noise_is_bounded() -> None:
    here = f"udpin:127.0.0.1:{free_port()}"
    listener = VehicleListener(IDS, (here,))
    listener.listen(())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.connect(("127.0.0.1", int(here.rpartition(":")[2])))
        sender.send(b"\xfd" * 900)
        vehicles = [on_line(FakeVehicle(system=system), endpoint=here) for system in range(1, 30)]
        for each in vehicles:
            each.__enter__()
        assert len(await heard(listener, 16)) == 16
        for each in vehicles:
            each.__exit__(None, None, None)
    listener.close()
