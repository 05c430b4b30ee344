"""The loop of the watchdog's process, run in this one: real sockets of station, screen, vehicle and terminal."""

from __future__ import annotations

import os
import pty
import select
import socket
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

import pytest

from dialects import codec
from dialects.enums import Autopilot, VehicleType
from dialects.messages import Heartbeat, ManualControl
from groundstation.intents.session import Quit, RenewLease
from groundstation.ipc import IntentBatch, decode_from_station, encode
from groundstation.snapshot import StationOutage
from groundstation.station.driving.driven import DrivenVehicle
from groundstation.watchdog.process import WatchdogProcess, fork_watchdog
from groundstation.watchdog.report import DemandRoute, StationReport, encode_report
from groundstation.watchdog.terminal_reset import RESET, TerminalReset
from link.protocol.framer import Framer
from tests.groundstation.watchdog.test_terminal_guard import ignores_hangup
from tests.waits import wait_until

ARDUROVER = DrivenVehicle(system=2, component=1, name="ArduPilot rover 2", autopilot=Autopilot.ARDUPILOT)
DRIVING = StationReport(vehicles=(ARDUROVER,), routes=(DemandRoute(0, None, 10),))
ENDED = "station process ended: "


class Loop:
    """A watchdog's loop with both ends of everything that it talks to."""

    def __init__(self, stack: ExitStack) -> None:
        pairs = [socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET) for _ in range(2)]
        for end in (*pairs[0], *pairs[1]):
            stack.enter_context(closing(end))
            end.setblocking(False)
        (self.station, theirs), (self.screen, screen) = pairs
        self.rover = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.rover.bind(("127.0.0.1", 0))
        self.rover.settimeout(20.0)
        self.line = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.line.connect(self.rover.getsockname())
        self.line.setblocking(False)
        self.master, self.slave = pty.openpty()
        stack.callback(os.close, self.master)
        stack.callback(os.close, self.slave)
        self.keys_read = 0
        terminal = TerminalReset(os.ttyname(self.slave))
        tty.setraw(self.slave)
        self.process = WatchdogProcess(theirs, screen, terminal, None, self._read_keys)

    def _read_keys(self) -> None:
        self.keys_read += 1

    def report(self, report: StationReport, *descriptors: int) -> None:
        socket.send_fds(self.station, [encode_report(report)], list(descriptors))

    def run_to_the_end(self, *, answer: bool = False) -> list[ManualControl]:
        """Run the loop until it returns, without a station; return what the rover got, which may say it is disarmed."""
        runs = threading.Thread(target=self.process.run)
        runs.start()
        self.station.close()
        demands = [self.receive(answer=True)] if answer else []
        self.run_to_the_end_of(runs)
        while select.select([self.rover], [], [], 0.0)[0]:
            demands.append(self.receive())
        return demands

    def run_to_the_end_of(self, runs: threading.Thread) -> None:
        """End the station, and wait until the loop has returned."""
        self.station.close()
        runs.join(20.0)
        assert not runs.is_alive()

    def receive(self, *, answer: bool = False) -> ManualControl:
        """Receive a demand, and answer it with a HEARTBEAT that says disarmed."""
        data, address = self.rover.recvfrom(1000)
        if answer:
            beat = Heartbeat(VehicleType.GROUND_ROVER, Autopilot.ARDUPILOT, 0, 0, 4, 3)
            self.rover.sendto(codec.frame(0, codec.encode_payload(beat), 1, 2, 1), address)
        ((number, _, _, _, raw),) = Framer(stream=False).feed(data, 0.0)
        message = codec.decode_frame(number, raw)
        assert isinstance(message, ManualControl)
        return message

    def outages(self) -> list[StationOutage]:
        """Return what the screen got."""
        found = []
        while select.select([self.screen], [], [], 0.0)[0] and (packet := self.screen.recv(65536)):
            outage = decode_from_station(packet)
            assert isinstance(outage, StationOutage)
            found.append(outage)
        return found

    def written(self) -> bytes:
        """Return what came to the terminal."""
        return os.read(self.master, 4096) if select.select([self.master], [], [], 0.0)[0] else b""


@pytest.fixture
def loop() -> Iterator[Loop]:
    with ExitStack() as stack:
        yield Loop(stack)


def test_a_killed_station_is_neutral_until_the_rover_disarms(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    demands = loop.run_to_the_end(answer=True)
    assert {(each.target, each.x, each.y, each.z, each.r) for each in demands} == {(2, 32767, 0, 0, 32767)}
    assert 2 <= len(demands) <= 22
    assert loop.outages() == [
        StationOutage(ENDED + "neutral is sent to ArduPilot rover 2", True),
        StationOutage(ENDED + "ArduPilot rover 2 is disarmed", True),
    ]


def test_a_station_that_ends_in_order_needs_no_neutral(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    loop.report(StationReport(ending=True))
    assert loop.run_to_the_end() == []
    assert loop.outages() == []
    assert loop.written() == b""


def test_a_report_without_descriptors_keeps_the_last_ones(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    loop.report(StationReport(vehicles=(ARDUROVER,), routes=DRIVING.routes, keeps_descriptors=True))
    assert loop.run_to_the_end(answer=True)


def test_keys_are_read_once_for_each_change(loop: Loop) -> None:
    for version in (0, 1, 1, 2):
        loop.report(StationReport(keys_version=version))
    loop.run_to_the_end()
    assert loop.keys_read == 2


def test_a_station_that_is_silent_and_goes_on_is_shown(loop: Loop) -> None:
    runs = threading.Thread(target=loop.process.run)
    loop.report(StationReport())
    runs.start()
    assert select.select([loop.screen], [], [], 20.0)[0]
    assert loop.outages() == [StationOutage("station not responding: nothing is sent", False)]
    loop.report(StationReport())
    assert select.select([loop.screen], [], [], 20.0)[0]
    assert loop.outages()[0] == StationOutage()
    loop.report(StationReport(ending=True))
    loop.run_to_the_end_of(runs)


def test_both_killed_resets_the_terminal_once(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.close()
    loop.run_to_the_end()
    assert loop.written() == RESET


def test_a_screen_that_still_runs_keeps_its_terminal(loop: Loop) -> None:
    loop.report(StationReport())
    loop.run_to_the_end()
    assert loop.written() == b""


def quits(loop: Loop) -> None:
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(),))))
    loop.screen.send(b"\xc1 no intents")
    loop.screen.send(encode(IntentBatch(1.0, (Quit(),))))


def says_that_it_quits(loop: Loop) -> None:
    loop.report(StationReport(screen_has_quit=True))
    loop.report(StationReport())


@pytest.mark.parametrize("leaves", [quits, says_that_it_quits])
def test_a_screen_that_has_quit_keeps_its_terminal(loop: Loop, leaves: Callable[[Loop], None]) -> None:
    loop.report(StationReport())
    leaves(loop)
    loop.screen.close()
    loop.run_to_the_end()
    assert loop.written() == b""


def test_other_intents_than_quit_do_not_stop_the_reset(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(),))))
    loop.screen.close()
    loop.run_to_the_end()
    assert loop.written() == RESET


def report_after_a_while(loop: Loop, report: StationReport) -> None:
    select.select([loop.master], [], [], 0.05)
    loop.report(report)


def test_a_killed_screen_of_a_running_station_is_reset(loop: Loop) -> None:
    """The station goes on for a while without a screen, and says that it is gone."""
    runs = threading.Thread(target=loop.process.run)
    loop.report(StationReport())
    runs.start()
    loop.screen.close()
    gone = StationReport(screen_is_gone=True, rests=True)  # the station goes on to report it
    wait_until(lambda: select.select([loop.master], [], [], 0.0)[0], each=lambda: report_after_a_while(loop, gone))
    assert loop.written() == RESET
    loop.report(StationReport(ending=True))
    loop.run_to_the_end_of(runs)
    assert loop.written() == b"", "once"


def test_a_screen_that_sends_intents_is_not_gone(loop: Loop) -> None:
    """They stay unread once the station is gone."""
    loop.report(StationReport())
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(),))))
    loop.run_to_the_end()
    assert loop.written() == b""


def test_a_screen_that_is_gone_may_have_told_its_station_why(loop: Loop) -> None:
    runs = threading.Thread(target=loop.process.run)
    loop.report(StationReport(rests=True))
    runs.start()
    loop.screen.close()
    wait_until(lambda: loop.process._screen_gone, each=lambda: report_after_a_while(loop, StationReport(rests=True)))
    for report in (StationReport(screen_has_quit=True), StationReport(ending=True)):
        loop.report(report)
    loop.run_to_the_end_of(runs)
    assert loop.written() == b""


def test_a_silent_station_whose_screen_is_killed_is_reset(loop: Loop) -> None:
    runs = threading.Thread(target=loop.process.run)
    loop.report(StationReport())
    runs.start()
    loop.screen.close()
    assert select.select([loop.master], [], [], 20.0)[0]
    assert loop.written() == RESET
    loop.run_to_the_end_of(runs)
    assert loop.written() == b"", "once"


def test_a_report_that_keeps_descriptors_may_change_addresses(loop: Loop) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        for address, keeps in ((("127.0.0.1", 9), False), (loop.rover.getsockname(), True)):
            report = StationReport(
                vehicles=(ARDUROVER,), routes=(DemandRoute(0, address, 10),), keeps_descriptors=keeps
            )
            loop.report(report, *([] if keeps else [ours.fileno()]))
        assert loop.run_to_the_end(answer=True)


def test_without_keys_a_change_of_them_is_nothing(loop: Loop) -> None:
    loop.process._read_keys = None
    loop.report(StationReport(keys_version=3))
    loop.run_to_the_end()
    assert loop.outages() == [StationOutage(ENDED + "nothing is sent", True)]


def test_the_forked_process_ends_with_its_station(loop: Loop) -> None:
    process, station = fork_watchdog(loop.screen, None)
    with station:
        assert not os.get_blocking(station.fileno())
        wait_until(
            lambda: os.getsid(process) == process and ignores_hangup(process), "the end of a terminal is not its own"
        )
        station.send(encode_report(StationReport(ending=True)))
    assert os.waitpid(process, 0)[1] == 0
