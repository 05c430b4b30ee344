"""Opens and closes links while the station runs, and finds what they could lead to."""
