"""Quests: a program has to find out something about a robot that the judge draws."""
