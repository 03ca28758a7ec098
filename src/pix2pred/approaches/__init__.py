"""The paper's ablations and rivals (method 9): the same skills, demonstrations, tasks and settings for all."""
