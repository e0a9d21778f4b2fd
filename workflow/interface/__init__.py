"""Functions of the module `granchain`, with the names and arguments of the commands."""
