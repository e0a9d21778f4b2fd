"""The reference integrator: `engine` runs a scheme, `certify` bounds its error, one file a scheme."""
