"""One module for each kind of subject: its scenario, criteria and common mistakes."""
