"""Sweeps: a scene and lists or ranges of its fields -> one run directory per case, computed on all cores.

`file` is what a user writes and the cases that follow, `file_parts` what every file with a scene has, `fields` the
dotted paths in a scene, `cases` the record of a case in its directory, `run_sweep` the sweep, `case_decks` its decks in
place of runs; `collect` gathers the cases into one table, `run_table` single runs, `statistics` has statistics of its
columns, `axes` the words for fields and quantities.
"""
