"""Parts of the core that outlive a fault of the station's process."""
