"""`mavhelm bridge doctor`: listens on endpoints, and tells who is heard and where their frames would go. Sends nothing.

To add or change:
- what `bridge doctor` examines of an endpoint: a function in `link/bridge/doctor/rows.py`; its row in `table.py`,
  `ROWS`; what it judges: a field of `facts.py`, filled in `listen.py`.
"""
