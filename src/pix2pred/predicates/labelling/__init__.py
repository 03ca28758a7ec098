"""Truth values of atoms from a model's answers."""
