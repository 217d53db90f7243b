"""Define the messages between the autograder's processes: lines of JSON, each of a type defined here."""
