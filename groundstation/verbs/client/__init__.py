"""A verb that a station runs, as its shell sees it: finds the station, prints, and has the files of the user."""
