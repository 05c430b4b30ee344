"""What drivers of motors, sensors and accessories share."""
