"""`mavhelm learn`: its command line, and how replay and attach continue its lesson."""
