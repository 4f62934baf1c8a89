"""Verification: runs compared with exact solutions, references and independent searches."""
