"""What authors of exercises work with: a new exercise from a recipe, its answers, and what the judge says of them."""
