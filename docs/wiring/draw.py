"""Draws the wiring of each motor board as SVG: python docs/wiring/draw.py writes docs/wiring/*.svg.

BOARDS is the table: a wire joins a pin of the Pi, a supply or a motor to a terminal of the board. A new board is a row
there.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

FOLDER = Path(__file__).parent
ROW = 26
"""px between two wires."""
WIDTH, TOP, BOX = 790, 56, 180
LEFT, MIDDLE, RIGHT = 20, 305, 590
"""x of the Raspberry Pi, the board, and what is behind it."""
TEXT = 13
"""px of the letters; one is at most 0.62 of it wide in a font of fixed width."""


class Wire(NamedTuple):
    """A wire from the left or right to a terminal of the board."""

    terminal: str
    """Of the board."""
    other: str
    """Pin of the Pi on the left, or what is on the right."""
    colour: str


class Board(NamedTuple):
    """A board between the Pi and the motors."""

    title: str
    pi: tuple[Wire, ...]
    power: tuple[Wire, ...]
    note: str = ""


SIGNAL, PWM, GROUND, SUPPLY, LOGIC, MOTOR = "#1f6fb4", "#8a4fb0", "#404040", "#c0392b", "#d07a1c", "#2e7d4f"
BATTERY = (Wire("GND", "battery -", GROUND),)

_IN = (
    Wire("IN1", "GPIO 23  pin 16", SIGNAL), Wire("IN2", "GPIO 24  pin 18", SIGNAL),
    Wire("IN3", "GPIO 27  pin 13", SIGNAL), Wire("IN4", "GPIO 22  pin 15", SIGNAL),
)  # fmt: skip
_OUT = (
    Wire("OUT1", "left motor +", MOTOR), Wire("OUT2", "left motor -", MOTOR),
    Wire("OUT3", "right motor +", MOTOR), Wire("OUT4", "right motor -", MOTOR),
)  # fmt: skip

BOARDS = {
    "l298n-enable": Board(
        "L298N, jumpers on ENA and ENB removed",
        (
            Wire("ENA", "GPIO 12  pin 32", PWM), *_IN, Wire("ENB", "GPIO 13  pin 33", PWM),
            Wire("GND", "GND  pin 14", GROUND),
        ),
        (*_OUT, Wire("+12V", "battery + 7-12 V", SUPPLY), *BATTERY),
        "PWM on ENA and ENB. Leave the 5V terminal open.",
    ),
    "l298n-jumpers": Board(
        "L298N, jumpers on ENA and ENB in place",
        (*_IN, Wire("GND", "GND  pin 14", GROUND)),
        (*_OUT, Wire("+12V", "battery + 7-12 V", SUPPLY), *BATTERY),
        "PWM on IN1 to IN4: no `enable` in rover.toml. Leave the 5V terminal open.",
    ),
    "tb6612": Board(
        "TB6612FNG, STBY switched by the vehicle",
        (
            Wire("PWMA", "GPIO 12  pin 32", PWM), Wire("AIN1", "GPIO 23  pin 16", SIGNAL),
            Wire("AIN2", "GPIO 24  pin 18", SIGNAL), Wire("BIN1", "GPIO 27  pin 13", SIGNAL),
            Wire("BIN2", "GPIO 22  pin 15", SIGNAL), Wire("PWMB", "GPIO 13  pin 33", PWM),
            Wire("STBY", "GPIO 25  pin 22", SIGNAL), Wire("VCC", "3V3  pin 17", LOGIC),
            Wire("GND", "GND  pin 14", GROUND),
        ),
        (
            Wire("AO1", "left motor +", MOTOR), Wire("AO2", "left motor -", MOTOR),
            Wire("BO1", "right motor +", MOTOR),
            Wire("BO2", "right motor -", MOTOR), Wire("VM", "battery + 4.5-13.5 V", SUPPLY), *BATTERY,
        ),
        "VCC is the logic: 3V3, not 5 V. Without the wire to STBY, join STBY to 3V3.",
    ),
    "bts7960": Board(
        "BTS7960 (IBT-2), the left motor; the right one has a board of its own",
        (
            Wire("RPWM", "GPIO 12  pin 32", PWM), Wire("LPWM", "GPIO 13  pin 33", PWM),
            Wire("R_EN", "GPIO 25  pin 22", SIGNAL), Wire("L_EN", "GPIO 25  pin 22", SIGNAL),
            Wire("VCC", "3V3  pin 17", LOGIC), Wire("GND", "GND  pin 14", GROUND),
        ),
        (
            Wire("M+", "left motor +", MOTOR), Wire("M-", "left motor -", MOTOR),
            Wire("B+", "battery + 6-27 V", SUPPLY), Wire("B-", "battery -", GROUND),
        ),
        "R_EN and L_EN share one pin: `enable_pin`. VCC is the logic: 3V3, not 5 V.",
    ),
    "pca9685": Board(
        "PCA9685 with ESCs and servos",
        (
            Wire("VCC", "3V3  pin 1", LOGIC), Wire("SDA", "GPIO 2  pin 3", SIGNAL),
            Wire("SCL", "GPIO 3  pin 5", SIGNAL), Wire("GND", "GND  pin 9", GROUND),
        ),
        (
            Wire("channel 0", "left ESC, throttle", PWM), Wire("channel 1", "right ESC, steering", PWM),
            Wire("V+", "servo supply 5-6 V", SUPPLY), Wire("GND", "servo supply -", GROUND),
        ),
        "V+ has a supply of its own, never the Pi. The grounds are joined by the board.",
    ),
    "esc": Board(
        "Servo ESC at a pin with hardware PWM (`sysfs-pwm`)",
        (
            Wire("signal 1", "GPIO 12  pin 32", PWM), Wire("signal 2", "GPIO 13  pin 33", PWM),
            Wire("GND", "GND  pin 14", GROUND),
        ),
        (
            Wire("motor 1", "left motor", MOTOR), Wire("motor 2", "right motor", MOTOR),
            Wire("B+", "battery +", SUPPLY), Wire("B-", "battery -", GROUND),
        ),
        "Two ESCs, drawn as one. Leave the red wire of each plug open: it is the ESC's own 5 V.",
    ),
}  # fmt: skip
"""Name of the file -> the board."""


class Text(NamedTuple):
    """A text and the rectangle that it takes, for the test of overlaps."""

    x: float
    y: float
    text: str
    anchor: str = "start"
    size: int = TEXT

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Return left, top, right, bottom, px."""
        width = len(self.text) * self.size * 0.62
        left = {"start": self.x, "middle": self.x - width / 2, "end": self.x - width}[self.anchor]
        return left, self.y - self.size * 0.8, left + width, self.y + self.size * 0.25


def rows(board: Board) -> int:
    """Return how many wires the longer side has."""
    return max(len(board.pi), len(board.power))


def height(board: Board) -> int:
    """Return the height of the drawing, px."""
    return TOP + (rows(board) + 1) * ROW + 44


def texts(board: Board) -> Iterator[Text]:
    """Yield all texts of a drawing."""
    yield Text(WIDTH / 2, 22, board.title, "middle", 15)
    yield Text(WIDTH / 2, height(board) - 12, board.note, "middle")
    for x, name in ((LEFT, "Raspberry Pi"), (MIDDLE, "board"), (RIGHT, "motors, supply")):
        yield Text(x + BOX / 2, TOP - 8, name, "middle")
    for number, wire in enumerate(board.pi):
        yield Text(LEFT + BOX - 8, _y(number) + 4, wire.other, "end")
        yield Text(MIDDLE + 8, _y(number) + 4, wire.terminal)
    for number, wire in enumerate(board.power):
        yield Text(MIDDLE + BOX - 8, _y(number) + 4, wire.terminal, "end")
        yield Text(RIGHT + 8, _y(number) + 4, wire.other)


def _y(number: int) -> int:
    return TOP + (number + 1) * ROW - 4


def draw(board: Board) -> str:
    """Return the drawing as SVG. It has its own white ground, so that it can be read in dark pages too."""
    tall = (rows(board) + 1) * ROW - 8
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height(board)}" role="img">',
        f"<title>{escape(board.title)}</title>",
        f'<rect width="{WIDTH}" height="{height(board)}" rx="8" fill="#ffffff"/>',
    ]
    for x, fill in ((LEFT, "#e8f3ea"), (MIDDLE, "#e9eef7"), (RIGHT, "#f6efe6")):
        parts.append(f'<rect x="{x}" y="{TOP}" width="{BOX}" height="{tall}" rx="6" fill="{fill}" stroke="#8a8a8a"/>')
    for wires, begin, end in ((board.pi, LEFT + BOX, MIDDLE), (board.power, MIDDLE + BOX, RIGHT)):
        for number, wire in enumerate(wires):
            y = _y(number)
            parts.append(f'<path d="M{begin} {y}H{end}" stroke="{wire.colour}" stroke-width="3" fill="none"/>')
            parts += [f'<circle cx="{x}" cy="{y}" r="4" fill="{wire.colour}"/>' for x in (begin, end)]
    parts += [
        f'<text x="{each.x:g}" y="{each.y:g}" text-anchor="{each.anchor}" font-size="{each.size}" '
        f'font-family="monospace" fill="#202020" xml:space="preserve">{escape(each.text)}</text>'
        for each in texts(board)
    ]
    return "\n".join([*parts, "</svg>\n"])


if __name__ == "__main__":
    for name, board in BOARDS.items():
        (FOLDER / f"{name}.svg").write_text(draw(board))
