"""The compiled core, in the build that suits the processor."""
