"""From a measured log to a joint: readers of files, and identification.

In come log files and mappings, out go logs and joints with intervals. Nothing here is drawn.
"""
