"""Force as gauges on walls, in contacts and inside beads measure it, and what walls give back; finds no waves."""
