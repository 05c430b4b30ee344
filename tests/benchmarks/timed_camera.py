"""A camera whose pictures tell when they were made, also in a few cells: 20 black and white fields.

Run as a program in place of `rpicam-vid`; writes yuv420p of WIDTH x HEIGHT, RATE pictures a second. The fields are 16
bits of ms of the monotonic clock and 4 bits of their sum, row by row, the highest bit first.
"""

from __future__ import annotations

import os
import time

WIDTH, HEIGHT, RATE = 320, 180, 15
COLUMNS, ROWS = 5, 4
BITS = COLUMNS * ROWS
TIME_BITS = 16
BLACK, WHITE = 20, 230


def build_fields(milliseconds: int) -> list[int]:
    """Return the bits of a time."""
    number = milliseconds & 0xFFFF
    total = sum(number >> shift & 0xF for shift in (0, 4, 8, 12)) & 0xF
    return [(number << 4 | total) >> shift & 1 for shift in reversed(range(BITS))]


def read_fields(fields: list[int]) -> int | None:
    """Return the ms of the fields; None if their sum is wrong."""
    whole = sum(bit << shift for bit, shift in zip(fields, reversed(range(BITS)), strict=True))
    number = whole >> 4
    return number if build_fields(number) == fields else None


def draw(milliseconds: int, count: int) -> bytes:
    """Return one picture: each field has texture, so that all cells change from picture to picture."""
    fields = build_fields(milliseconds)
    texture = bytes((7 * x + 11 * count) % 40 for x in range(WIDTH + HEIGHT))
    rows = []
    for y in range(HEIGHT):
        line = bytearray(texture[y % 60 : y % 60 + WIDTH])
        for column in range(COLUMNS):
            if fields[y * ROWS // HEIGHT * COLUMNS + column]:
                left, right = column * WIDTH // COLUMNS, (column + 1) * WIDTH // COLUMNS
                line[left:right] = line[left:right].translate(_LIGHTER)
        rows.append(line)
    chroma = bytes(108 + (x + 3 * count) % 40 for x in range(WIDTH // 2)) * (HEIGHT // 2)
    return b"".join(rows) + chroma + chroma[::-1]


_LIGHTER = bytes(max(0, WHITE - value) for value in range(256))


def main() -> None:
    """Write pictures until the pipe is closed."""
    began, count = time.monotonic(), 0
    while True:
        count += 1
        time.sleep(max(0.0, began + count / RATE - time.monotonic()))
        picture = memoryview(draw(int(time.monotonic() * 1000), count))
        while picture:
            picture = picture[os.write(1, picture) :]


if __name__ == "__main__":
    main()
