"""The browser application: build a case, watch it, map it, and keep what was found.

It uses the public interface of Rattlebox only, and holds no physics. `serve` starts it; `rattlebox app` calls that.
"""
