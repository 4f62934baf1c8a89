"""The seed paper, reproduced and judged: one figure a file."""

from .report import write_report

__all__ = ["write_report"]
