"""The program `mavhelm`: the ground station, and the other programs of the project by their first word.

It imports what the chosen program needs and nothing else, so that `mavhelm vehicle` starts as fast as `vehicle`.
"""
