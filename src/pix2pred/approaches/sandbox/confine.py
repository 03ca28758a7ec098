"""Taking every right away from the present process: it can compute, read what it was given and write its answer.

Imported by the confined process, where only the standard library exists. Resource limits bound memory, processor time,
files and output; a seccomp filter then kills the process at any system call beyond the few that computing needs, so
that no file, socket, process or executable page can be had, whoever the user is. Linux on x86-64 and ARM-64 only:
elsewhere ``confine`` raises, and nothing is run.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys

_X86 = {
    "read": 0, "write": 1, "munmap": 11, "brk": 12, "rt_sigaction": 13, "rt_sigprocmask": 14, "rt_sigreturn": 15,
    "mremap": 25, "madvise": 28, "exit": 60, "sigaltstack": 131, "futex": 202, "clock_gettime": 228,
    "exit_group": 231, "mmap": 9, "mprotect": 10,
}  # fmt: skip
_ARM = {
    "read": 63, "write": 64, "munmap": 215, "brk": 214, "rt_sigaction": 134, "rt_sigprocmask": 135,
    "rt_sigreturn": 139, "mremap": 216, "madvise": 233, "exit": 93, "sigaltstack": 132, "futex": 98,
    "clock_gettime": 113, "exit_group": 94, "mmap": 222, "mprotect": 226,
}  # fmt: skip
_MACHINES = {"x86_64": (0xC000003E, _X86), "aarch64": (0xC00000B7, _ARM)}
"""Audit number of the architecture and the numbers of the allowed system calls."""

_MAY_NOT_EXECUTE = ("mmap", "mprotect")

_LOAD, _IF_EQUAL, _IF_AT_LEAST, _IF_BITS, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_NUMBER, _ARCHITECTURE, _THIRD_ARGUMENT = 0, 4, 32
_PROT_EXEC = 4
_X32 = 0x40000000
_SET_DUMPABLE, _SET_SECCOMP, _SET_NO_NEW_PRIVS, _SECCOMP_FILTER = 4, 22, 38, 2


class ConfinementError(RuntimeError):
    """This system cannot confine a process."""


def confine(megabytes: int, cpu_seconds: int) -> None:
    """Give up every right for good. Raises ``ConfinementError`` where that is not possible."""
    machine = platform.machine()
    if not sys.platform.startswith("linux") or machine not in _MACHINES:
        raise ConfinementError(f"confining processes needs Linux on x86-64 or ARM-64, not {sys.platform} on {machine}")
    import resource  # which other systems do not have

    libc = ctypes.CDLL(None, use_errno=True)
    os.chdir("/")
    os.closerange(3, 4096)
    memory = megabytes * 2**20
    for what, limit in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, cpu_seconds),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, 3),
        (resource.RLIMIT_NPROC, 0),
    ):
        resource.setrlimit(what, (limit, limit))
    program = _filter(*_MACHINES[machine])
    code = ctypes.create_string_buffer(program)
    header = ctypes.create_string_buffer(struct.pack("HxxxxxxP", len(program) // 8, ctypes.addressof(code)))
    for call in (
        (_SET_DUMPABLE, 0, 0, 0, 0),
        (_SET_NO_NEW_PRIVS, 1, 0, 0, 0),
        (_SET_SECCOMP, _SECCOMP_FILTER, ctypes.addressof(header), 0, 0),
    ):
        if libc.prctl(*(ctypes.c_ulong(argument) for argument in call)) != 0:
            raise ConfinementError(f"this system refuses to confine a process (prctl {call[0]}: {ctypes.get_errno()})")


def _filter(architecture: int, calls: dict[str, int]) -> bytes:
    """The seccomp program: another architecture or an unlisted call kills, as do executable pages."""
    steps = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_IF_EQUAL, 1, 0, architecture),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER),
        (_IF_AT_LEAST, 0, 1, _X32),
        (_RETURN, 0, 0, _KILL),
    ]
    for name, number in calls.items():
        if name in _MAY_NOT_EXECUTE:
            steps += [
                (_IF_EQUAL, 0, 4, number),
                (_LOAD, 0, 0, _THIRD_ARGUMENT),
                (_IF_BITS, 0, 1, _PROT_EXEC),
                (_RETURN, 0, 0, _KILL),
                (_RETURN, 0, 0, _ALLOW),
            ]
        else:
            steps += [(_IF_EQUAL, 0, 1, number), (_RETURN, 0, 0, _ALLOW)]
    steps.append((_RETURN, 0, 0, _KILL))
    return b"".join(struct.pack("HBBI", *step) for step in steps)
