"""One scene with several engines: runs, what each finds, and what the differences mean."""
