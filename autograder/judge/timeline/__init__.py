"""What a card shows of the events of a check: its timeline, and where a run leaves the reference solution's."""
