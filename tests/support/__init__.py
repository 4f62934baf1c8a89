"""Helpers of the tests: cases, exact solutions, independent programs, and programs that tests interrupt."""
