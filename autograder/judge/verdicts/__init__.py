"""From a look at a subject to its verdict, and to the reference output that it is held against."""
