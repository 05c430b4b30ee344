"""Doctor: why the vehicle cannot be driven, and what to do. One table for the Setup screen and for the verb.

To add or change:
- a link of the chain from the finger to the wheel: a function in `groundstation/doctor/`; its row in `chain.py`,
  `CHAIN`; what it judges: a field of `facts.py`, filled in `groundstation/station/doctor/doctor_facts.py`.
- advice for a reason why a vehicle does not arm: `groundstation/doctor/prearm_advice.py`, `ADVICE`.
"""
