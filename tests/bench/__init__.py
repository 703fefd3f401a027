"""Benchmarks: speed, memory, and what cracks add."""
