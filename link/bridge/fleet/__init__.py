"""`bridge router` and `bridge fleet`: the router of a fleet, and the certificates of those who may connect."""
