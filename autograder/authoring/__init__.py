"""The tools of authors of exercises: a new exercise from a recipe, its answers, and what the judge says of them."""
