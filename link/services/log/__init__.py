"""The log protocol: LOG_REQUEST_LIST, LOG_DATA."""
