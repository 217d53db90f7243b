"""A class and the course that it was made of: whether the course has moved on, and bringing the class up to date."""
