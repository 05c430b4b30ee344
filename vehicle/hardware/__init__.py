"""Code shared by the drivers of motors, sensors and accessories: the I2C bus, error texts and install hints."""
