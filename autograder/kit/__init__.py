"""What exercises are written with: the model, the evidence, and what several exercises ask of it."""
