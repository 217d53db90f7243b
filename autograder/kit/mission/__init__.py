"""Exercises about things that drive: a world whose time is the subject's, and what must happen in it."""
