"""The watchdog's process, stepped in this one in virtual time: real sockets of station, screen, vehicle and terminal.

`run`, which reads the clock, is tested where nothing has to wait for longer than a station may be silent.
"""

from __future__ import annotations

import os
import pty
import select
import signal
import socket
import termios
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress

import pytest

from dialects import codec
from dialects.enums import Autopilot, VehicleType
from dialects.messages import Heartbeat, ManualControl
from groundstation.intents.session import Quit, RenewLease
from groundstation.ipc import IntentBatch, decode_from_station, encode
from groundstation.snapshot import StationOutage
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.watchdog.process import WatchdogProcess, fork_watchdog
from groundstation.watchdog.report import DemandRoute, StationReport, encode_report
from groundstation.watchdog.screen_end import ScreenEnd
from groundstation.watchdog.terminal_reset import RESET, TerminalReset
from link.protocol.framer import Framer
from link.runtime.local_socket import open_pair
from tests.groundstation.watchdog.test_terminal_guard import ignores_hangup
from tests.waits import wait_until

ARDUROVER = WatchdogTarget(system=2, component=1, name="ArduPilot rover 2", autopilot=Autopilot.ARDUPILOT, kind=10)
DRIVING = StationReport(vehicles=(ARDUROVER,), routes=(DemandRoute(0, None, 10),))
ENDED = "station process ended: "


class Loop:
    """A watchdog's loop with both ends of everything that it talks to."""

    def __init__(self, stack: ExitStack) -> None:
        pairs = [open_pair() for _ in range(2)]
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
        self.now = 1000.0
        terminal = TerminalReset(os.ttyname(self.slave))
        tty.setraw(self.slave)
        self.ends = theirs, screen
        self.process = WatchdogProcess(theirs, ScreenEnd(screen), terminal, None, self._read_keys)

    def _read_keys(self) -> None:
        self.keys_read += 1

    def report(self, report: StationReport, *descriptors: int) -> None:
        socket.send_fds(self.station, [encode_report(report)], list(descriptors))

    def step(self, seconds: float = 0.0) -> None:
        """Handle what waits, `seconds` later."""
        self.now += seconds
        self.process.step(self.process.wait(0.0), self.now)

    def end(self, *, answer: bool = False) -> list[ManualControl]:
        """End the station, and go on for as long as the watchdog may send.

        Returns what the rover got. With `answer` it says at the first demand that it is disarmed.
        """
        self.station.close()
        demands: list[ManualControl] = []
        for _ in range(600):
            self.step(0.01)
            while select.select([self.rover], [], [], 0.0)[0]:
                demands.append(self.receive(answer=answer and not demands))
        self.process.finish()
        return demands

    @contextmanager
    def running(self) -> Iterator[None]:
        """Run the loop in real time meanwhile; then end the station and wait until it has returned."""
        runs = threading.Thread(target=self.process.run)
        runs.start()
        yield
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
    demands = loop.end(answer=True)
    assert {(each.target, each.x, each.y, each.z, each.r) for each in demands} == {(2, 32767, 0, 0, 32767)}
    assert 2 <= len(demands) <= 22
    assert loop.outages() == [
        StationOutage(ENDED + "neutral is sent to ArduPilot rover 2", True),
        StationOutage(ENDED + "ArduPilot rover 2 is disarmed", True),
    ]


def test_a_rover_that_is_silent_gets_neutral_for_5_s(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    assert len(loop.end()) > 22
    assert loop.outages()[-1] == StationOutage(ENDED + "ArduPilot rover 2 may still move", True)


def test_a_station_that_ends_in_order_needs_no_neutral(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    loop.report(StationReport(ending=True))
    assert loop.end() == []
    assert loop.outages() == []
    assert loop.written() == b""


def test_a_report_without_descriptors_keeps_the_last_ones(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    loop.report(StationReport(vehicles=(ARDUROVER,), routes=DRIVING.routes, keeps_descriptors=True))
    assert loop.end(answer=True)


def test_a_report_that_keeps_descriptors_may_change_addresses(loop: Loop) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        for address, keeps in ((("127.0.0.1", 9), False), (loop.rover.getsockname(), True)):
            report = StationReport(
                vehicles=(ARDUROVER,), routes=(DemandRoute(0, address, 10),), keeps_descriptors=keeps
            )
            loop.report(report, *([] if keeps else [ours.fileno()]))
        assert loop.end(answer=True)


def test_a_line_that_is_gone_is_told_to_the_screen(loop: Loop) -> None:
    ours, theirs = socket.socketpair()
    with ours:
        loop.report(DRIVING, ours.fileno())
        loop.step()
        theirs.close()
        loop.end()
    text = "neutral could NOT be sent to ArduPilot rover 2 (Broken pipe)"
    assert loop.outages()[-1] == StationOutage(ENDED + text, True)
    assert loop.process.wait(0.0) == [], "the end of a stream is an event for ever"


def test_a_vehicle_that_starts_again_is_heard(loop: Loop) -> None:
    """Until then the kernel refuses what is sent to its port, and says so when that is read."""
    address = loop.rover.getsockname()
    loop.report(DRIVING, loop.line.fileno())
    loop.step()
    loop.rover.close()
    loop.station.close()
    for _ in range(3):
        loop.step(0.1)
    loop.rover = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with loop.rover:
        loop.rover.bind(address)
        for _ in range(10):
            loop.step(0.1)
        loop.receive(answer=True)
        loop.step(0.1)
    assert loop.outages()[-1] == StationOutage(ENDED + "ArduPilot rover 2 is disarmed", True)


def test_what_a_vehicle_sends_is_left_to_its_station(loop: Loop) -> None:
    loop.report(DRIVING, loop.line.fileno())
    loop.step()
    loop.rover.sendto(b"telemetry", loop.line.getsockname())
    assert loop.process.wait(0.0) == []
    loop.step(0.31)  # the station is silent, but may go on and read it
    assert loop.receive().target == 2
    assert loop.process.wait(0.0) == []
    assert loop.line.recv(1000) == b"telemetry"


def test_keys_are_read_once_for_each_change(loop: Loop) -> None:
    for version, read in ((0, 0), (1, 1), (1, 1), (2, 2)):
        loop.report(StationReport(keys_version=version))
        loop.step()
        assert loop.keys_read == read


def test_without_keys_a_change_of_them_is_nothing(loop: Loop) -> None:
    process = WatchdogProcess(loop.ends[0], None, TerminalReset(None))
    loop.report(StationReport(keys_version=3))
    process.step(process.wait(0.0), 1000.0)
    assert loop.outages() == []


@pytest.mark.parametrize(("rests", "silent", "shown"), [(False, 0.25, 0.1), (True, 1.0, 1.0)])
def test_a_station_that_is_silent_and_goes_on_is_shown(loop: Loop, rests: bool, silent: float, shown: float) -> None:
    loop.report(StationReport(rests=rests))
    loop.step()
    loop.step(silent)
    assert loop.outages() == []
    loop.step(shown)
    assert loop.outages() == [StationOutage("station not responding: nothing is sent", False)]
    loop.report(StationReport())
    loop.step(0.01)
    assert loop.outages() == [StationOutage()]


def test_a_screen_that_does_not_read_is_told_later(loop: Loop) -> None:
    with suppress(BlockingIOError):
        while True:
            loop.ends[1].send(b"snapshot")
    loop.report(DRIVING, loop.line.fileno())
    loop.station.close()
    loop.step(0.01)
    assert loop.receive().target == 2
    while select.select([loop.screen], [], [], 0.0)[0]:
        loop.screen.recv(100)
    loop.step(0.01)
    assert loop.outages() == [StationOutage(ENDED + "neutral is sent to ArduPilot rover 2", True)]


def test_the_end_of_station_and_screen_is_one_event(loop: Loop) -> None:
    """Else the watchdog would take all the time of a processor."""
    loop.report(StationReport())
    loop.step()
    assert loop.process.wait(0.0) == []
    for end in (loop.screen, loop.station):
        end.close()
        assert len(loop.process.wait(0.0)) == 1
        loop.step()
        assert loop.process.wait(0.0) == []


def test_both_killed_resets_the_terminal_once(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.close()
    loop.end()
    assert loop.written() == RESET


def test_a_screen_that_still_runs_keeps_its_terminal(loop: Loop) -> None:
    loop.report(StationReport())
    loop.end()
    assert loop.written() == b""


def test_a_screen_killed_at_the_very_end_is_reset(loop: Loop) -> None:
    loop.report(StationReport())
    loop.end()
    loop.screen.close()
    loop.process.finish()
    assert loop.written() == RESET


def quits(loop: Loop) -> None:
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(),))))
    loop.screen.send(b"\xc1 no intents")
    loop.screen.send(encode(IntentBatch(1.0, (Quit(),))))


def quits_with_the_last_intents(loop: Loop) -> None:
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(), Quit()))))


def says_that_it_quits(loop: Loop) -> None:
    loop.report(StationReport(screen_has_quit=True))
    loop.report(StationReport())


@pytest.mark.parametrize("leaves", [quits, quits_with_the_last_intents, says_that_it_quits])
def test_a_screen_that_has_quit_keeps_its_terminal(loop: Loop, leaves: Callable[[Loop], None]) -> None:
    loop.report(StationReport())
    leaves(loop)
    loop.screen.close()
    loop.end()
    assert loop.written() == b""


def test_other_intents_than_quit_do_not_stop_the_reset(loop: Loop) -> None:
    loop.report(StationReport())
    for intents in ((RenewLease(),), ()):
        loop.screen.send(encode(IntentBatch(1.0, intents)))
    loop.screen.close()
    loop.end()
    assert loop.written() == RESET


def test_a_killed_screen_of_a_running_station_is_reset(loop: Loop) -> None:
    """The station goes on for a while without a screen, and says that it is gone."""
    loop.report(StationReport())
    loop.screen.close()
    loop.step()
    assert loop.written() == b"", "the station may still read that the screen has quit"
    loop.report(StationReport(screen_is_gone=True))
    loop.step(0.1)
    assert loop.written() == RESET
    loop.report(StationReport(screen_is_gone=True))
    loop.step(0.1)
    loop.end()
    assert loop.written() == b"", "once"


def test_a_screen_that_sends_intents_is_not_gone(loop: Loop) -> None:
    """They stay unread once the station is gone."""
    loop.report(StationReport())
    loop.screen.send(encode(IntentBatch(1.0, (RenewLease(),))))
    loop.end()
    assert loop.written() == b""


def test_a_screen_that_is_gone_may_have_told_its_station_why(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.close()
    loop.step()
    for report in (StationReport(screen_has_quit=True), StationReport(ending=True)):
        loop.report(report)
    loop.end()
    assert loop.written() == b""


def test_a_silent_station_whose_screen_is_killed_is_reset(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.close()
    loop.step()
    loop.step(0.31)
    assert loop.written() == RESET
    loop.end()
    assert loop.written() == b"", "once"


def test_the_loop_waits_for_the_silence_of_its_station(loop: Loop) -> None:
    with loop.running():
        loop.report(StationReport())
        assert select.select([loop.screen], [], [], 20.0)[0]
        assert loop.outages() == [StationOutage("station not responding: nothing is sent", False)]
        loop.report(StationReport(ending=True))
    assert loop.outages() == [StationOutage()]


def test_a_full_terminal_is_reset_in_the_end(loop: Loop) -> None:
    loop.report(StationReport())
    loop.screen.close()
    termios.tcflow(loop.slave, termios.TCOOFF)
    with loop.running():
        loop.station.close()
        select.select([loop.master], [], [], 0.1)
        termios.tcflow(loop.slave, termios.TCOON)
    assert loop.written() == RESET


@pytest.fixture
def hangup() -> Iterator[None]:
    """A hangup ends processes: not so under nohup."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("hangup")
def test_the_forked_process_ends_with_its_station(loop: Loop) -> None:
    process, station = fork_watchdog(loop.screen, None)
    with station:
        assert not os.get_blocking(station.fileno())
        wait_until(
            lambda: os.getsid(process) == process and ignores_hangup(process), "the end of a terminal is not its own"
        )
        station.send(encode_report(StationReport()))
    assert os.waitpid(process, 0)[1] == 0
    assert decode_from_station(loop.ends[1].recv(65536)) == StationOutage(ENDED + "nothing is sent", True)


def test_the_forked_process_does_not_keep_the_stations_pipe_open(loop: Loop) -> None:
    """The screen sees the end of a station at once, though its watchdog goes on."""
    screen, pipe = open_pair()
    process, station = fork_watchdog(loop.screen, None, of_station=pipe)
    with screen, station:
        pipe.close()
        screen.settimeout(20.0)
        assert screen.recv(10) == b""
        assert os.waitpid(process, os.WNOHANG) == (0, 0)
    assert os.waitpid(process, 0)[1] == 0
