"""Intents: what an operator wants, sent from the screen's process to the station process.

Intents are msgspec structs because keys are read in the screen's process and handled in the station process. A new one
is a class in a module here and its handler: in station/services/service_calls.py if it is a request to a service of a
vehicle, else in station/intent_handler.py. The keys of intents are in groundstation/actions.py.
"""
