"""Making a project: declarations, drafts, photos, the example. What other rooms use is named here."""

from pix2pred.demos.authoring.declaring import DeclarationError, Declarations, declare
from pix2pred.demos.authoring.domain_text import domain_text
from pix2pred.demos.authoring.drafts import Draft, refuse_begun, write_drafts
from pix2pred.demos.authoring.example import example_declarations, example_drafts
from pix2pred.demos.authoring.photos import Order
from pix2pred.demos.authoring.sharing import bare_demo, bare_task
from pix2pred.demos.photos.copies import MAX_SIDE, clean_copy

__all__ = [
    "MAX_SIDE",
    "DeclarationError",
    "Declarations",
    "Draft",
    "Order",
    "bare_demo",
    "bare_task",
    "clean_copy",
    "declare",
    "domain_text",
    "example_declarations",
    "example_drafts",
    "refuse_begun",
    "write_drafts",
]
