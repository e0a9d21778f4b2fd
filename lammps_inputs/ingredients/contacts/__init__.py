"""Laws of contacts, one a file: what the keys of `contact` choose."""
