"""The messages between the autograder's processes: lines of JSON, each of a type that is defined here."""
