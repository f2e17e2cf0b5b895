"""Kratos Multiphysics on a model of igaprep: scripts/solve_kratos.py."""
