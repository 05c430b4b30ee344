"""Help texts of the verbs: examples, words of MAVProxy, shells."""
