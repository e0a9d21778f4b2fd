"""A trajectory against another of the same scene: at the same times, how far apart they are, and what departs from the
scene.

Where the other trajectory comes from (an accurate reference, a user's table) is not known here; see
`workflow.verdicts`.
"""
