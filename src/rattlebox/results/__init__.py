"""What comes back: runs, impacts, the energy ledger, and their files."""
