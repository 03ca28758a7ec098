"""Simulated domains: each folder holds one world with its skills, pictures, demonstrations and tasks."""
