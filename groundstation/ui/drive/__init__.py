"""The Drive screen: layout, instruments, panes, and the page shown while no vehicle is found.

To add or change:
- what the page without a vehicle advises for a link type: `groundstation/ui/drive/waiting_advice.py`, `_BY_SCHEME`.
- a pane of the Drive screen: `groundstation/ui/drive/panes.py`, `PANES`: its widget, its value and the views that it
  requests.
"""
