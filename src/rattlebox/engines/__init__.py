"""From a case to the core and back to a run."""
