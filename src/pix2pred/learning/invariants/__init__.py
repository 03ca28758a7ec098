"""What always holds, learned from demonstrations and operators, and how far labels can be trusted."""

from pix2pred.learning.invariants.acquaintance import Acquaintance, acquaint

__all__ = ["Acquaintance", "acquaint"]
