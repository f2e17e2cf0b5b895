"""iga: from a CAD or surface file to a number with its error, by igaprep and igasolve alone."""
