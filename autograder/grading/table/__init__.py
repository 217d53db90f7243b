"""The one table of a class: what the gradebook says, beside it what the judge said and what waits for a person."""
