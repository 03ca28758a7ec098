"""Juice: fruit is juiced into cups, cups are emptied and put under the right valve (method 10.5)."""

from pix2pred.domains.juice.domain import JuiceDomain

__all__ = ["JuiceDomain"]
