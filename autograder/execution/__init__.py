"""Executing the course's notebooks: masters earn full marks, chapters reach their end and earn nothing."""
