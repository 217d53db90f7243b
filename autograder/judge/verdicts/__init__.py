"""Turn the evidence of a check into a verdict, and record the reference output with which evidence is compared."""
