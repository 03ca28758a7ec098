"""Coffee: a jug is put into a machine, filled, and poured into cups (method 10.3)."""

from pix2pred.domains.coffee.domain import CoffeeDomain

__all__ = ["CoffeeDomain"]
