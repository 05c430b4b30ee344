"""What the vehicle sends, to whom, and how often.

To add or change:
- telemetry, its rate and who understands it: `vehicle/telemetry/streams.py`, `STREAMS`; its builder in a `build_*.py`
  beside it.
"""
