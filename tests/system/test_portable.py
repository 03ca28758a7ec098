"""Every module can be imported where Python lacks what only Unix has."""

from __future__ import annotations

import subprocess
import sys

BLOCKED = ("fcntl", "resource", "termios", "tty", "pty", "pwd", "grp", "posix", "syslog", "readline", "curses")

IMPORT_ALL = f"""
import builtins, importlib, pkgutil, sys
BLOCKED = {BLOCKED!r}
EXTRAS = ('bosdyn', 'cryptography', 'google', 'grpc', 'gymnasium', 'jwt', 'mujoco', 'unified_planning')
original = builtins.__import__

def blocking(name, globals=None, locals=None, fromlist=(), level=0):
    if name.partition('.')[0] in BLOCKED and str((globals or {{}}).get('__name__')).startswith('pix2pred'):
        raise ModuleNotFoundError(f'no module called {{name}}, as on Windows')
    return original(name, globals, locals, fromlist, level)

builtins.__import__ = blocking
sys.modules.pop('pix2pred', None)
import pix2pred
names = [m.name for m in pkgutil.walk_packages(pix2pred.__path__, 'pix2pred.') if not m.name.endswith('__main__')]
for name in names:
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:  # a module about an optional package needs it
        if (error.name or '').partition('.')[0] not in EXTRAS:
            raise
print(len(names))
"""


def test_every_module_is_imported_without_what_only_unix_has() -> None:
    done = subprocess.run([sys.executable, "-c", IMPORT_ALL], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout) > 200
