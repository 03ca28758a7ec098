"""Which predicates are kept."""
