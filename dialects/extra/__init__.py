"""A further dialect from a user's XML file, which adds messages to the built-in ones when a program starts."""
