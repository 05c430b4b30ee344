"""Files of other ground stations: parameters and plans, read and written. No I/O: text in, text out."""
