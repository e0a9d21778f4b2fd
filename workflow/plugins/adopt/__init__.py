"""Scenes from LAMMPS decks of users: LAMMPS evaluates the deck, and its forces are measured."""
