"""The shape of a wave: the exact solitary wave, and what passes a bead as recorded.

Which passage belongs to which wave is found in `analysis.tracking`; whether a wave counts as solitary is said in
`analysis.sharing`.
"""
