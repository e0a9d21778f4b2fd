"""Pages to look at a run or a sweep with: one self-contained HTML file each, drawn by Bokeh. Computes nothing new."""
