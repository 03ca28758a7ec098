"""Planning-competition-like domains with hidden predicates and noisy candidates: a benchmark of ``pix2pred select``."""
