"""Right: as the card shows it."""

print("the name of the topic")
