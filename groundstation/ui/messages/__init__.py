"""The Messages screen without its widgets: rows, the chosen field, calls to the station, and records as CSV."""
