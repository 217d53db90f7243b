"""Decides to which student and notebook a collected file belongs, and which file of a student is graded."""
