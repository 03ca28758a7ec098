"""Two series of photos of somebody making tea, and what is declared of them."""

from __future__ import annotations

from pathlib import Path

from demos.photo_files import photo

OPTIONS = (
    "--type", "robot", "--type", "pot", "--type", "cup",
    "--object", "robot:robot", "--object", "pot:pot = the tea pot", "--object", "mug:cup = the blue mug",
    "--skill", "Pick(robot, cup)", "--skill", "Pour(robot, pot, cup)",
    "--predicate", "Holding(robot, cup) = skills: +Pick(0, 1)", "--predicate", "Full(cup) = vlm: full_of_tea",
)  # fmt: skip
ACTIONS = ("Pick(robot, mug)", "Pour(robot, pot, mug)")
GOAL = "Full(mug)"


def take_photos(folder: Path) -> None:
    """Three photos of each day, held upright, whose names are out of order."""
    for d, day in enumerate(("monday", "tuesday")):
        for i in range(3):
            time = f"2026:05:0{d + 1} 10:0{i}:00"
            photo(folder / day / f"{(i + 2) % 3}.jpg", seed=10 * d + i, time=time, orientation=6)


def fill_in(file: Path) -> None:
    """Write the goal and the actions in place of what was left open."""
    text = file.read_text()
    for filling in (GOAL, *ACTIONS):
        text = text.replace("- TODO", f'- "{filling}"', 1)
    file.write_text(text)
