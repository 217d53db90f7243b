"""The results of tasks, entered into the gradebook by one writer."""
