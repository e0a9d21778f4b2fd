"""Scenes of this package."""
