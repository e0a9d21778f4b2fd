"""What a scene wants recorded, and what is read from the frames: forces, spectra."""
