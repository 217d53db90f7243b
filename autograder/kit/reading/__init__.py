"""What the evidence says of texts, of calls of a service and of goals, for criteria and mistakes."""
