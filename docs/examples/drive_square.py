"""Drive a square with a simulated rover, or with the one at an endpoint: `python docs/examples/drive_square.py`."""

import sys

from groundstation import Rover

with Rover(*sys.argv[1:]) if sys.argv[1:] else Rover.simulated() as rover:
    rover.arm()
    for corner in range(4):
        rover.drive(0.4, seconds=1.5)
        rover.turn(90)
        print("corner", corner + 1, rover.position, flush=True)
