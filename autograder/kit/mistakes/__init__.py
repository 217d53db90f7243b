"""Known mistakes: how each is recognized in the evidence, and the advice that the student gets."""
