"""One module for each autonomous mode except AUTO, which is vehicle/autonomy/mission."""
