"""The sources of a workspace: which packages there are, and which files belong to them."""
