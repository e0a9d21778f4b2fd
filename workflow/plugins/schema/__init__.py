"""`granchain schema`: JSON schemas of the files that users write, for editors."""
