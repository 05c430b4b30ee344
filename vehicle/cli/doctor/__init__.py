"""`mavhelm vehicle doctor`: all that the vehicle needs on its computer, a row each. Nothing moves.

To add or change:
- what it examines: a function in `vehicle/cli/doctor/`; its row in `table.py`, `ROWS`; what it judges:
  a field of `facts.py`, filled in `gather.py`.
"""
