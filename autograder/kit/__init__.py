"""The vocabulary of exercises: the model, the evidence, and the rules and mistakes that several exercises share."""
