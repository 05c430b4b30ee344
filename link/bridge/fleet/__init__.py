"""`mavhelm bridge router` and `mavhelm bridge fleet`: the router of a fleet, and the certificates of its members."""
