"""One scene with several engines: `study` runs it and takes the numbers, `answer` says what they mean."""
