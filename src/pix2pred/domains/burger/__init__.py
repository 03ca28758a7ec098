"""Burger: a grid kitchen where a robot cooks, chops and stacks (method 10.2)."""

from pix2pred.domains.burger.domain import BurgerDomain

__all__ = ["BurgerDomain"]
