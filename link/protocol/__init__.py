"""MAVLink framing, sequence numbers, peers and the channel that joins them."""
