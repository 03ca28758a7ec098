"""Kitchen: a robot arm turns on a burner and pushes a kettle onto it, in MuJoCo (method 10.1)."""

from pix2pred.domains.kitchen.domain import KitchenDomain

__all__ = ["KitchenDomain"]
