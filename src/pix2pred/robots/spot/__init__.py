"""A Spot with an arm, by its vendor's client (extra ``spot``).

The client comes under the vendor's own licence: it may be used with the vendor's products, and with simulations of
them in software. Nothing of it is part of this package.
"""
