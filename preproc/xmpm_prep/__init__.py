"""Particles and cracks for XMPM3D from gmsh models, STEP, meshes and STL."""

__version__ = "0.1.0"
