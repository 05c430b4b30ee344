"""Probes of what a vehicle understands: dialect, streams, signing.

To add or change:
- telemetry to request from other autopilots: `groundstation/vehicles/probes/stream_requests.py`, `STREAM_RATES`.
"""
