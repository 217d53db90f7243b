"""The results of tasks, entered into journal and gradebook by one writer."""
