"""`vehicle doctor`: all that the vehicle needs on its computer, a row each. Nothing moves."""
