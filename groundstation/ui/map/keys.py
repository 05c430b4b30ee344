"""Keys of the Map screen, for the footer and the help, and how far each arrow moves the cursor."""

from __future__ import annotations

from groundstation.ui.display.display_state import ScreenKey

COARSE = 10
"""Cells that the cursor moves with shift."""

STEPS: dict[str, tuple[int, int]] = {
    "up": (1, 0),
    "down": (-1, 0),
    "left": (0, -1),
    "right": (0, 1),
    "shift+up": (COARSE, 0),
    "shift+down": (-COARSE, 0),
    "shift+left": (0, -COARSE),
    "shift+right": (0, COARSE),
    "pageup": (COARSE, 0),
    "pagedown": (-COARSE, 0),
    "home": (0, -COARSE),
    "end": (0, COARSE),
}
"""Key -> cells up and to the right."""

MAP_KEYS = (
    ScreenKey("a", "Add", "Add an item at the cursor, behind the selected one"),
    ScreenKey("enter", "Edit", "Edit the item under the cursor; in its panel the selected field"),
    ScreenKey("x", "Del", "Remove the selected item"),
    ScreenKey("U", "Upload", "Upload the edited plan; while armed it asks", commands=True),
    ScreenKey("G", "Go", "Drive to the cursor now; asks", commands=True),
    ScreenKey("tab", "Table", "Next panel: map, table, item"),
    ScreenKey(
        "P", "Start/pause", "Start the mission, go on with it, or pause it; what moves the vehicle asks", commands=True
    ),
    ScreenKey("e", "Layer", "Edit the mission, the fence or the rally points"),
    ScreenKey("u", "Undo", "Undo the last edit; Ctrl-R does it again"),
    ScreenKey("f", "Fit", "Show everything"),
    ScreenKey("c", "Follow", "Keep the vehicle in view"),
    ScreenKey("plus", "Zoom", "Zoom in; minus zooms out"),
    ScreenKey("slash", "Filter", "Show the items of the table with these words; Escape shows all"),
    ScreenKey("y", "Copy", "Copy latitude and longitude of the cursor"),
    ScreenKey("l", "Layers", "Hide the GeoJSON layers, or show them again"),
    ScreenKey("D", "Download", "Download the edited plan again; drops the edits of it"),
    ScreenKey("m", "Move here", "Move the selected item to the cursor"),
    ScreenKey("less_than_sign", "Up", "Move the selected item up in the plan; > moves it down"),
    ScreenKey("b", "Measure", "Measure from the cursor; again ends it"),
    ScreenKey("p", "Polygon", "Begin another polygon of the fence at the cursor"),
    ScreenKey("J", "Jump", "Make the selected item the next one that AUTO drives to; asks", commands=True),
    ScreenKey("H", "Home", "Move home to the cursor; asks", commands=True),
    ScreenKey("X", "Clear", "Clear the edited plan on the vehicle; asks", commands=True),
    ScreenKey("F", "Fence", "Switch the fence on; off asks", commands=True),
    ScreenKey("C", "Cancel", "Cancel the transfers that run"),
    ScreenKey("O", "Open", "Open a plan (.plan, .waypoints), or a layer to look at (.geojson)"),
    ScreenKey("S", "Save", "Save the plans: .plan, .waypoints, .geojson"),
    ScreenKey(
        "1", "Mode", "1 MANUAL, 2 HOLD, 3 AUTO, 4 GUIDED, 5 RTL, 6 LOITER; one that moves by itself asks", commands=True
    ),
)
