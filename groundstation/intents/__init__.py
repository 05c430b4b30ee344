"""Intents: what an operator wants, sent from the screen's process to the station process.

Intents are msgspec structs because keys are read in the screen's process and handled in the station process. A new one
is a class in a module here. A command to the selected vehicle (VehicleIntent) and a request to a service of a vehicle
(ServiceIntent) need no more; any other has its handler in station/intent_handler.py. The keys of intents are in
groundstation/actions.py.
"""
