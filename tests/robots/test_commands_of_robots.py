"""``pix2pred robot`` as people and programs use it: a process that serves, one that works, and one that is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from command_line import run as command
from extras import need

PASSWORD = "planted-s3cret-7f1c"
SECRETS = {"BOSDYN_CLIENT_USERNAME": "user", "BOSDYN_CLIENT_PASSWORD": PASSWORD}
