"""``robot``: a simulated Spot, what to know before one moves, a map of tags, and tasks on one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from pix2pred.api import load_solver
from pix2pred.cli.console import UsageError, counted, err, out, plain, print_json, say
from pix2pred.cli.ranges import NOT_NEGATIVE, POSITIVE, between, output_file, output_folder
from pix2pred.cli.robot_watching import AtTheTerminal, Silent, asked
from pix2pred.demos import write_task
from pix2pred.registry import Registry, check_family
from pix2pred.robots.addresses import SimulatedEpisode, SpotAt, read_address
from pix2pred.robots.robot import Outcome
from pix2pred.robots_by_name import checked_spot, mapped_tags, simulated_robot, simulated_spot, spot
from pix2pred.runs.folder import RunFolder
from pix2pred.runs.robot_session import RobotSession, task_for
from pix2pred.structs.environment import SimulatedTask

robot = App(name="robot")

SIDE = between(0.01, 2)
"""Metres of a tag's side."""

AsJson = Annotated[bool, Parameter(negative=(), help="Print one JSON object on the last line.")]
Certificate = Annotated[
    Path | None, Parameter(help="Certificate of a simulated Spot [default: that of the vendor's robots].")
]


# Longer than others: every option is a line, with its help.
@robot.command
def simulate(
    *,
    domain: Annotated[str, Parameter(help="cleanup, juice, or a domain in which a robot can walk.")] = "cleanup",
    family: Annotated[str | None, Parameter(help="Family of the scene [default: the domain's first].")] = None,
    seed: Annotated[int, Parameter(help="Varies the scene, and drift and chance.", validator=NOT_NEGATIVE)] = 0,
    index: Annotated[int, Parameter(help="Which test task's scene.", validator=NOT_NEGATIVE)] = 0,
    out_dir: Annotated[
        Path, Parameter(name="--out", help="Folder for its certificate and the task.", validator=output_folder)
    ] = Path("simulated-spot"),
    port: Annotated[int, Parameter(help="Port on the loopback address [default: a free one].")] = 0,
    pace: Annotated[float, Parameter(help="Seconds of motion in a second.", validator=POSITIVE)] = 1.0,
    fault: Annotated[
        list[str] | None,
        Parameter(
            help="What goes wrong: lease-lost, estop, fall, battery-empty, camera-timeout, slow, each @MOMENT; "
            "grasp-miss:P, blocked:P, drift:SHARE. May be repeated.",
            consume_multiple=True,
        ),
    ] = None,
    json: AsJson = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Run a simulated Spot that speaks the robot's own protocol, until Ctrl-C.

    It listens on the loopback address alone. Any program written with the vendor's client runs against it.

    For example:

    - `pix2pred robot simulate --domain cleanup --family new-objects --seed 0 --out spot`
    - `pix2pred robot simulate --domain juice --fault grasp-miss:0.2 --fault drift:0.05 --pace 5`
    """
    made = registry.domain(domain)
    family = family or made.families[0]
    check_family(made, family)
    server = simulated_spot(made, family, seed, index, out_dir, port, pace, fault or ())
    try:
        chosen = made.tasks(family, seed, index + 1)[index].task
        write_task(out_dir, made.vocabulary(family), SimulatedTask(chosen, {}), overwrite=True)
        task = out_dir / "tasks" / chosen.name
        if json:
            print_json(
                {"host": "127.0.0.1", "port": server.port, "certificate": str(server.certificate), "task": str(task)}
            )
        else:
            say(f"A simulated Spot answers at 127.0.0.1, port {server.port}, with certificate {server.certificate}.")
            say(f"Its user is {server.login.user!r}, and its password {server.login.password!r}. In another terminal:")
            out.print(
                f"  export BOSDYN_CLIENT_USERNAME={server.login.user} BOSDYN_CLIENT_PASSWORD={server.login.password}\n"
                f"  pix2pred robot check 127.0.0.1 --port {server.port} --certificate {server.certificate}\n"
                f"  pix2pred robot run RUN --robot spot:127.0.0.1:{server.port} --certificate {server.certificate} "
                f"--task {task}",
                markup=False,
                soft_wrap=True,
            )
            err.print("Ctrl-C ends it.", style="dim")
        server.wait()
    except KeyboardInterrupt:
        err.print("ended", style="dim")
    finally:
        server.close()
    return 0


@robot.command
def check(
    host: Annotated[str, Parameter(help="Name or address of the robot.")],
    /,
    *,
    port: Annotated[int | None, Parameter(help="Port of a simulated Spot.", validator=POSITIVE)] = None,
    certificate: Certificate = None,
    json: AsJson = False,
) -> int:
    """Say what a person needs to know before a Spot moves; nothing moves it here.

    Name and password come from BOSDYN_CLIENT_USERNAME and BOSDYN_CLIENT_PASSWORD, or are asked for.

    For example:

    - `pix2pred robot check 192.168.80.3`
    """
    findings = checked_spot(SpotAt(host, port), certificate)
    ready = all(f.fine for f in findings)
    if json:
        print_json({"ready": ready, "findings": [f.as_dict() for f in findings]})
        return 0 if ready else 1
    for finding in findings:
        mark = "[green]ok[/green]  " if finding.fine else "[red]look[/red]"
        out.print(f"{mark} {finding.what:<12} ", end="")
        out.print(plain(finding.said), markup=False, soft_wrap=True)
    say("Ready." if ready else "Not ready: see above.")
    return 0 if ready else 1


@robot.command(name="map")
def map_tags(
    host: Annotated[str, Parameter(help="Name or address of the robot.")],
    /,
    *,
    out_file: Annotated[Path, Parameter(name="--out", help="The map, for run --map.", validator=output_file)],
    tag_size: Annotated[float, Parameter(help="Side of the tags' black square, in metres.", validator=SIDE)] = 0.3,
    turn: Annotated[bool, Parameter(negative=(), help="Let the robot stand up and turn about itself.")] = False,
    looks: Annotated[int, Parameter(help="End after so many looks [default: Ctrl-C].", validator=POSITIVE)] = 1000,
    yes: Annotated[bool, Parameter(negative=(), help="Do not ask before the robot moves.")] = False,
    port: Annotated[int | None, Parameter(help="Port of a simulated Spot.", validator=POSITIVE)] = None,
    certificate: Certificate = None,
    json: AsJson = False,
) -> int:
    """Make a map of the tags on the walls, while somebody walks the robot about with its tablet.

    The map begins where the robot looks first: let it stand there where it shall look at its tasks from. Whenever it
    has been walked on it looks again; stop now and then. Nothing moves it or takes it here, except with --turn.

    For example:

    - `pix2pred robot map 192.168.80.3 --tag-size 0.146 --out hall.json`
    - `pix2pred robot map 127.0.0.1 --port 4443 --certificate spot/robot.pem --turn --out hall.json`
    """
    if turn and not yes and (json or not asked("The robot will stand up and turn about itself. Go on? [y/N] ")):
        raise UsageError("nothing was moved; --yes lets it move without asking")
    taken = 0

    def enough(seen: Sequence[int]) -> bool:
        nonlocal taken
        taken += 1
        err.print(f"look {taken}: " + (f"tags {', '.join(map(str, seen))}" if seen else "no tag"), style="dim")
        return taken >= looks

    made = mapped_tags(SpotAt(host, port), certificate, tag_size, enough, turn=turn)
    made.tags.save(out_file)
    once = sorted(number for number, times in made.seen.items() if times == 1)
    if json:
        print_json({"map": str(out_file), "tags": sorted(made.tags.tags), "looks": made.looks, "seen_once": once})
    else:
        say(f"{counted(len(made.tags.tags), 'tag')} from {counted(made.looks, 'look')}: {out_file}")
        say(f"In the worst look, corners are {made.worst:.1f} pixels off.")
        if once:
            say(f"Seen from one place only, and thus less sure: {', '.join(map(str, once))}")
    return 0


# Longer than others: every option is a line, with its help.
@robot.command
def run(
    folder: Annotated[Path, Parameter(help="Run folder, as made by learn.")],
    /,
    *,
    robot: Annotated[str, Parameter(help="sim:DOMAIN/FAMILY/SEED[/INDEX] or spot:HOST[:PORT].")],
    task: Annotated[
        Path | None, Parameter(help="Folder of the task, with objects and goal [default with sim: that of the scene].")
    ] = None,
    certificate: Certificate = None,
    detector: Annotated[
        str, Parameter(help="What finds objects: bridge:MODEL beside the robot, vlm, or transformers:MODEL.")
    ] = "bridge:simulated-segmentation",
    map_file: Annotated[
        Path | None,
        Parameter(name="--map", help="Map of tags [default: RUN/robot/TASK/map.json, begun where it stands]."),
    ] = None,
    vlm: Annotated[str | None, Parameter(help="What looks at the pictures [default: what labelled the run].")] = None,
    planner: Annotated[
        str, Parameter(help="portfolio, astar-lmcut, gbfs-ff, or an engine of 'planners'.")
    ] = "portfolio",
    yes: Annotated[bool, Parameter(negative=(), help="Do not ask before the robot moves.")] = False,
    json: AsJson = False,
    registry: Annotated[Registry, Parameter(parse=False)],
) -> int:
    """Execute a task on a robot: look, plan, run a skill, look again.

    Asks before the robot stands up and before the first skill. Enter stops after the skill that runs, Ctrl-C at once;
    the arm is put away and the robot given back in any case, and the same command goes on from what is there then.

    Exit codes: 0 the goal holds in what was seen last, 1 it does not, 2 bad input.

    For example:

    - `pix2pred robot run runs/cleanup --robot sim:cleanup/new-objects/0`
    - `pix2pred robot run runs/cleanup --robot spot:192.168.80.3 --task data/tasks/monday --detector vlm`
    """
    if json and not yes:
        raise UsageError("--json needs --yes: a program cannot be asked before the robot moves")
    address = read_address(robot)
    RunFolder(folder).config()
    with RunFolder(folder).locked() as locked:
        solver, _ = load_solver(locked, planner, closed_loop=True, vlm=vlm, registry=registry)
        chosen = task_for(address, task, solver.model.vocabulary, registry.domain)
        session = RobotSession(locked, chosen)
        if isinstance(address, SimulatedEpisode):
            made = simulated_robot(registry, address, chosen)
        else:
            made = spot(registry, address, certificate, chosen, solver, detector, session.memory(map_file))
        watcher = Silent(session) if json or yes else AtTheTerminal(session)
        done = session.act(made, solver, watcher)
    if json:
        print_json(done.as_dict() | {"folder": str(session.path)})
    else:
        say(f"{done.outcome}: {done.detail}" if done.detail else str(done.outcome))
        say(f"written to {session.path}")
    return 0 if done.outcome is Outcome.GOAL else 1
