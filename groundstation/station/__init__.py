"""The ground station without a screen: operator, commands, arming, emergency stop."""
