"""A page served locally on which the numbers of a scene are changed and the reference integrator computes it anew."""
