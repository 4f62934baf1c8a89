"""One module for each kind of study."""
