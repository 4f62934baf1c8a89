"""Loss maps, and the response of structures from them."""
