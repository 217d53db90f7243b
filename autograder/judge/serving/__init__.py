"""A judge as a process: it listens, forks a child for each check, and leads the conversation of that check."""
