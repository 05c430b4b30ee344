"""State of each vehicle, and what the ground station requests from it.

To add or change:
- a request of the operator to a service of a vehicle: its method in a `groundstation/vehicles/requests/*_requests.py`;
  its intent, which calls the method, in `groundstation/intents/services.py`.
"""
