"""The app: start, exit, navigation, command line, palette and help."""
