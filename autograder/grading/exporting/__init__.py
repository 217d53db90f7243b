"""Exports from a class: points in the formats of learning management systems, and feedback as one zip."""
