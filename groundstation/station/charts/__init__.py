"""Recording of the fields that charts draw, and of the marks under their time axis."""
