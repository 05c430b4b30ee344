"""Links of the station: statistics, other ground stations, heartbeats."""
