"""The job that runs a deck on a cluster, as text: what a site asks for, the script, arrays of decks.

Whoever asks Slurm a question, or counts ranks, is in `workflow.cost_model`.
"""
