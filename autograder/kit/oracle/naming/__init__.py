"""Names what a subject does wrong that is compared with a solution: by mutants of the solution, or by the effect."""
