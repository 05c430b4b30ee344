"""Messages that verbs send through a running station."""
