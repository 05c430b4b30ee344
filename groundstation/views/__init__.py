"""Views: what a screen requests while it is shown, beside the snapshot. Nothing is sent for screens that are hidden.

A screen lists its requests (intent Watch); the station answers each with views, at the rate of its source, when they
have changed. Only the newest view of a kind counts. A new view is a request and a view in a module here, and a row in
Station.views (station/station.py).

To add or change:
- data that one screen needs beside the snapshot: a module in `groundstation/views/`: its request and its view;
  `groundstation/station/views/sources.py`: its row; `requests` and `show_view` of the screen.
"""
