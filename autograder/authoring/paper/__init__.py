"""A bench on paper for the solution and its mutants: an exercise without a network, in milliseconds."""
