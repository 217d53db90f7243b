"""Exports from a class: points in the formats of learning management systems (LMS), and feedback as a zip."""
