"""Making a project: declarations, drafts, photos, the example."""
