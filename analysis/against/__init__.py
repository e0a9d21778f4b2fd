"""A trajectory against another of the same scene: at the same times, how far apart they are, and symptoms of what is
wrong.

Where the other trajectory comes from (an accurate reference, a user's table) is not known here; see
`workflow.verdicts`.
"""
