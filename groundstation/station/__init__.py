"""Ground station core without a screen: operator, commands, arming, emergency stop."""
