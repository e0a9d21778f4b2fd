"""Ratios of two ways to do the same thing, measured side by side on this machine."""
