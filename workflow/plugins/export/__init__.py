"""A run or a sweep in files of other programs: arrays, tables, OVITO, VMD, films, figures with their numbers."""
