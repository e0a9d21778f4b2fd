"""What is said of a finished run: the waves in it (`analyse`), whether it is right (`validate`), and likely causes.

The measuring is done in `analysis`; here are the files, the words and the reference that it takes.
"""
