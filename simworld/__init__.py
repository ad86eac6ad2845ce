"""The world that tests the robot: building, body, sonar physics, people and errands."""
