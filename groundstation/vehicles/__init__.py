"""State of each vehicle, and what the ground station requests from it.

To add or change:
- a request of the operator to a service of a vehicle: its method in a `groundstation/vehicles/*_requests.py`; its
  intent in `groundstation/intents/services.py`; its row in `SERVICE_CALLS`
  (`groundstation/station/services/service_calls.py`).
"""
