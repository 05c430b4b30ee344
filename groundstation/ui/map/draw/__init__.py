"""Drawing of the map: scene, layers, ground, window."""
