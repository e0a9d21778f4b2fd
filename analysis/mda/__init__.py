"""MDAnalysis reads our run directories and finds the leading waves; nothing else of ours needs it."""
