"""What came of tasks, entered into journal and gradebook by one writer."""
