"""Search for designs: variables and objectives, trials, and their store. The kind of study is in `kinds/design.py`."""
