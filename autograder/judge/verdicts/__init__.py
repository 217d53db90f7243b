"""Turns the evidence of a check into a verdict, and records the reference outputs to which evidence is compared."""
