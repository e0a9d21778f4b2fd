"""Force as gauges on walls, in contacts and inside beads measure it; finds no waves."""
