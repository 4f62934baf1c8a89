"""`python -m rattlebox.cli`."""

from rattlebox.cli.main import main

main()
