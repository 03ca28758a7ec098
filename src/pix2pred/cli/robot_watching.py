"""What a person sees and may stop while a robot works: plan, next skill, pictures, belief."""

from __future__ import annotations

import sys
import threading

from pix2pred.cli.console import counted, err, out, plain, say
from pix2pred.execution import Guided, PlannedScene, SeenStep
from pix2pred.execution.explaining.wording import in_words
from pix2pred.robots.acting import Unwatched
from pix2pred.robots.robot import Robot
from pix2pred.runs.robot_session import RobotSession
from pix2pred.structs.environment import Step
from pix2pred.structs.plans import effects, signed


class Silent(Unwatched):
    """Asks nobody; keeps the pictures."""

    def __init__(self, session: RobotSession) -> None:
        self._session = session

    def looked(self, guided: Guided, look: SeenStep, step: Step) -> None:
        self._session.keep(look.state)


class AtTheTerminal:
    """Asks before the robot moves, says what it does, and stops after a skill when Enter is pressed."""

    def __init__(self, session: RobotSession) -> None:
        self._session = session
        self._stop = threading.Event()

    def may_move(self, robot: Robot) -> bool:
        return asked(f"{robot.name} is connected. It will stand up, walk to its place and look around. Go on? [y/N] ")

    def planned(self, scene: PlannedScene) -> bool:
        self._session.keep(scene.task.initial)
        say(f"{scene.task.name}: a plan of {counted(len(scene.result.plan), 'skill')}")
        for number, step in enumerate(scene.result.plan, start=1):
            out.print(f"{number:>3}  {plain(in_words(step))}", markup=False, soft_wrap=True)
        doubted = [a for a in scene.rests_on if 0.1 < scene.believed.get(a, 1.0) < 0.9]
        if doubted:
            say("It rests on what is in doubt: " + ", ".join(f"{a} ({scene.believed[a]:.0%})" for a in doubted))
        if not scene.result.plan:
            return True
        if not asked("Run it? [y/N] "):
            return False
        err.print("Enter stops after the skill that runs, Ctrl-C at once.", style="dim")
        threading.Thread(target=self._listen, daemon=True).start()
        return True

    def about_to(self, guided: Guided) -> bool:
        if self._stop.is_set():
            return False
        assert guided.step is not None, "there is a next step"
        say(f"\nnext, {len(guided.remaining)} to go:  {in_words(guided.step)}")
        say(f"     expected: {' '.join(signed(effects(guided.step)))}")
        return True

    def looked(self, guided: Guided, look: SeenStep, step: Step) -> None:
        folder = self._session.keep(look.state)
        if step.detail:
            say(f"     {step.detail}")
        if look.absent:
            say(f"     expected, not seen: {' '.join(signed(look.absent))}")
        if look.surplus:
            say(f"     seen, not expected: {' '.join(signed(look.surplus))}")
        if look.replanned:
            say(f"     planned again: {len(guided.remaining)} skills")
        say(f"     pictures: {folder}")

    def _listen(self) -> None:
        if sys.stdin.readline():
            self._stop.set()


def asked(question: str) -> bool:
    """Whether a person at the terminal says yes."""
    print(question, end="", flush=True, file=sys.stderr)
    return sys.stdin.readline().strip().lower() in ("y", "yes")
