"""How labels go wrong, which ones probably did, and which to check first."""
