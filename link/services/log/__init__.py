"""Log protocol: LOG_REQUEST_LIST, LOG_DATA."""
