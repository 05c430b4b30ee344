"""Notes of the station: the operator's log and the events in its recording."""
