"""The Links screen: vehicles and links.

To add or change:
- a column of the vehicles or links: `COLUMNS` and its cell in `groundstation/ui/links/vehicle_table.py` or
  `link_table.py`; its field in `groundstation/views/links.py`.
"""
