"""MAVLink frames, sequence numbers, peers, and the channel that joins them."""
