"""The seed paper, reproduced and judged: one figure a file."""
