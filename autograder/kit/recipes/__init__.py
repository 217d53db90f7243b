"""One module for each kind of subject: how it is driven, what can be asked of it, and which mistakes are common."""
