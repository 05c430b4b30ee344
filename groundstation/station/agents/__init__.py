"""Agents beside an operator: what they propose, and the key of a person that lets one proposal run.

To add or change:
- a tool of agents: `groundstation/verbs/agents/tools.py`.
- what ends the permission of a person: `_faults` or `interrupt` of ProposalBook in
  `groundstation/station/agents/proposals.py`.
"""
