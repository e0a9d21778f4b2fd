"""What studies are made of: their directories, options, pages, and quantities of scenes without a run directory."""
