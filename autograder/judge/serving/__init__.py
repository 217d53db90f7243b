"""A judge as a process: it listens, forks a child for each check, and exchanges that check's messages."""
