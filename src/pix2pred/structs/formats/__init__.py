"""Nouns as JSON: the shared documents, the world model's file, and the traces of labelled demonstrations."""
