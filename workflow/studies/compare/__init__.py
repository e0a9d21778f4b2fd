"""One scene with several engines: `study` runs it, `measure` takes the numbers, `answer` says what they mean."""
