"""Intents: what an operator wants, sent from the screen's process to the station process.

Intents are msgspec structs because keys are read in the screen's process and handled in the station process. A new one
is a class in a module here. A command to the selected vehicle is a VehicleIntent and needs no more. A request to a
service of a vehicle has its handler in station/services/service_calls.py, any other in station/intent_handler.py. The
keys of intents are in groundstation/actions.py.
"""
