"""The verbs on the command line of the screens: run by the station, over its own links and in its own session."""
