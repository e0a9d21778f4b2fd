"""The worker pool of all studies: tasks in, answers out, and a file of results that survives a kill."""
