"""What may fill the terminal: one module and one .tcss file a screen."""
