"""Functions that read the evidence for criteria and mistakes: published and reported texts, service calls, goals."""
