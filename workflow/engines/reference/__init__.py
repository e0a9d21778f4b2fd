"""The reference integrator: `engine` runs a scheme, `step_halving` bounds its error, one file a scheme."""
