"""The modules with which exercises are written: the model, the evidence, recipes, and common rules and mistakes."""
