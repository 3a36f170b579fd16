"""Scene states: the state of each object of a scene, judged in separate clusters."""
