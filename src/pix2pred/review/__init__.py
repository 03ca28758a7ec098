"""Correcting a run and answering a mailbox in the browser: one loopback server, and the append-only corrections."""

from pix2pred.review.log import CorrectionLog, StaleError
from pix2pred.review.mailbox import MailboxServer
from pix2pred.review.server import ReviewServer

__all__ = ["CorrectionLog", "MailboxServer", "ReviewServer", "StaleError"]
