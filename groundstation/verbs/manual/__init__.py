"""Words of MAVProxy, shells."""
