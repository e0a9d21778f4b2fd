"""Questions that take many runs, one a module or folder: each makes its runs, tables and figures.

For lists of values of a user's own there is `workflow.sweep`.
"""
