"""Reproduction of the reference paper: one file for each figure, with data, drawing, caption and claims."""

from .report import write_report

__all__ = ["write_report"]
