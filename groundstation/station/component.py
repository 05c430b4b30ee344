"""The component id of a ground station."""

COMPONENT = 190
"""MAV_COMP_ID_MISSIONPLANNER, which ground stations use."""
