"""The types of the messages between the autograder's processes. A message is a line of JSON."""
