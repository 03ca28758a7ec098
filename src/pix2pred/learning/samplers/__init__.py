"""Continuous parameters of skills."""
