"""The messages between the processes of the autograder: lines of JSON, each of a type that is named here."""
