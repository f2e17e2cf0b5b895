"""Decks for LS-DYNA: trimmed solids as generalized elements. scripts/export_lsdyna.py is the command."""
