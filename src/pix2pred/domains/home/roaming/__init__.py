"""Home worlds in which a robot walks about, looks from where it is, and moves things with its hand (method 10.6)."""

from pix2pred.domains.home.roaming.home import RoamingHome

__all__ = ["RoamingHome"]
