"""The field's canonical results, recomputed: an entry each, side by side on one page."""
