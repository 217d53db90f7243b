"""The solution as the judge's oracle: what is right is what the solution does with the same inputs."""
