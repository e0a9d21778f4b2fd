"""The engines: each turns a problem into a trajectory. They know nothing of each other."""
