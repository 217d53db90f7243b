"""Out of a class again: points in the forms that learning management systems take, and feedback as one zip."""
