"""`granchain cite`: the publications and the software that a paper on a scene cites."""
