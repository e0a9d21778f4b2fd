"""`granchain help`: explains keys, quantities, terms, options and commands, from the pages that declare them."""
