"""The words that exercises are written in: the model, the evidence, and what several exercises ask of it."""
