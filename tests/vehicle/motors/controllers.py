"""A RoboClaw and a Sabertooth as their manuals describe them: bytes and time in, replies and motor outputs out.

Written from the manuals and not from the drivers: they have their own checksums and their own idea of a timeout.
"""

from __future__ import annotations

import math
from typing import ClassVar, Protocol


class Controller(Protocol):
    """A motor controller on a serial line."""

    outputs: list[float]
    """What its two motors get, -1..1."""

    def feed(self, data: bytes, now: float) -> bytes:
        """Take bytes; what it answers."""

    def tick(self, now: float) -> None:
        """Let time pass: the motors stop after the serial timeout."""


class RoboClaw:
    """Packet serial mode. Its serial timeout is off until it is set, and forgotten with the power."""

    GAP = 0.01
    """s between two bytes of a packet after which the packet is thrown away."""
    DATA: ClassVar = {14: 1, 15: 0, 21: 0, 34: 4}
    """Bytes of data in each command."""
    READS = (15, 21)
    """These are sent without a CRC."""

    def __init__(self, address: int = 0x80) -> None:
        self.outputs = [0.0, 0.0]
        self.timeout = 0.0
        self.bad_packets = 0
        self.mute = False
        """Takes packets but its replies are lost: a broken wire."""
        self.longest_timeout = 25.5
        """A controller that does not keep what it was told."""
        self.garbled = 0
        """So many of the next replies to a read have a flipped bit."""
        self._address = address
        self._buffer = b""
        self._heard = self._last_byte = -math.inf

    def lose_power(self) -> None:
        self.outputs, self.timeout, self._buffer = [0.0, 0.0], 0.0, b""

    def feed(self, data: bytes, now: float) -> bytes:
        self.tick(now)
        if now - self._last_byte > self.GAP:
            self._buffer = b""
        self._last_byte = now
        self._buffer += data
        replies = b""
        while (packet := self._packet()) is not None:
            replies += self._obey(packet, now)
        return b"" if self.mute else replies

    def tick(self, now: float) -> None:
        if self.timeout and now - self._heard >= self.timeout:
            self.outputs = [0.0, 0.0]

    def _packet(self) -> bytes | None:
        if len(self._buffer) < 2:
            return None
        address, command = self._buffer[:2]
        if address != self._address or command not in self.DATA:
            self._buffer = b""
            self.bad_packets += 1
            return None
        length = 2 + self.DATA[command] + (0 if command in self.READS else 2)
        if len(self._buffer) < length:
            return None
        packet, self._buffer = self._buffer[:length], self._buffer[length:]
        return packet

    def _obey(self, packet: bytes, now: float) -> bytes:
        command = packet[1]
        if command in self.READS:
            self._heard = now
            return self._read(packet)
        if crc16(packet[:-2]) != int.from_bytes(packet[-2:], "big"):
            self.bad_packets += 1
            return b""
        self._heard = now
        if command == 14:
            self.timeout = min(packet[2] / 10, self.longest_timeout)
        else:
            duties = (int.from_bytes(packet[at : at + 2], "big", signed=True) for at in (2, 4))
            self.outputs = [duty / 32767 for duty in duties]
        return b"\xff"

    def _read(self, packet: bytes) -> bytes:
        data = b"USB Roboclaw 2x7a v4.2.8\n\0" if packet[1] == 21 else bytes([round(self.timeout * 10)])
        reply = data + crc16(packet + data).to_bytes(2, "big")
        if self.garbled:
            self.garbled -= 1
            reply = bytes([reply[0] ^ 1]) + reply[1:]
        return reply


def crc16(data: bytes) -> int:
    """As printed in the manual, "CRC16 Checksum Calculation"."""
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1
    return crc & 0xFFFF


class Sabertooth:
    """Packetized serial mode of a model that measures the baud rate: deaf until it has heard the byte 170."""

    def __init__(self, address: int = 128) -> None:
        self.outputs = [0.0, 0.0]
        self.timeout = 0.0
        self.bad_packets = 0
        self._address = address
        self._bauded = False
        self._packet = b""
        self._heard = -math.inf

    def lose_power(self) -> None:
        self.outputs, self.timeout, self._bauded, self._packet = [0.0, 0.0], 0.0, False, b""

    def feed(self, data: bytes, now: float) -> bytes:
        self.tick(now)
        for byte in data:
            self._byte(byte, now)
        return b""

    def tick(self, now: float) -> None:
        if self.timeout and now - self._heard >= self.timeout:
            self.outputs = [0.0, 0.0]

    def _byte(self, byte: int, now: float) -> None:
        if not self._bauded:
            self._bauded = byte == 170
            return
        self._packet = bytes([byte]) if byte >= 128 else self._packet + bytes([byte])
        if len(self._packet) == 4:
            if self._packet[0] == self._address:
                self._obey(self._packet, now)
            self._packet = b""

    def _obey(self, packet: bytes, now: float) -> None:
        address, command, value, checksum = packet
        if (address + command + value) % 128 != checksum:
            self.bad_packets += 1
            return
        self._heard = now
        if command in (0, 1, 4, 5):
            self.outputs[command // 4] = (-1 if command % 4 else 1) * value / 127
        elif command == 14:
            self.timeout = value / 10
