"""One package a process: sensor, detectors, classifier, geographer, decider, reactor."""
