"""Cleanup: tables are cleared and wiped, bins filled and dumped (method 10.4)."""

from pix2pred.domains.cleanup.domain import CleanupDomain

__all__ = ["CleanupDomain"]
