"""What the processes of the autograder say to each other: lines of JSON, each of a type that is named here."""
