"""The browser application: build a case, watch its motion, map a measure, and save the results.

It uses the public interface of Rattlebox only, and holds no physics. `serve` starts it; `rattlebox app` calls that.
"""
