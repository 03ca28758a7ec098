"""A program that walks and is killed: argv are port and certificate. Prints a line when it is on its way."""

from __future__ import annotations

import sys
import time

from pix2pred.robots.spot.credentials import credentials
from pix2pred.robots.spot.limbs import Limbs
from pix2pred.robots.spot.session import Address, SpotSession
from pix2pred.robots.spot.settings import Deadlines, SpotSettings
from pix2pred.structs.space.poses import FloorPose

port, certificate = int(sys.argv[1]), sys.argv[2]
settings = SpotSettings(deadlines=Deadlines(*[60.0] * 8), estop_timeout=3.0)
session = SpotSession(Address("127.0.0.1", port, certificate), credentials(), settings)
session.open()
session.take()
limbs = Limbs(session)
print("walking", flush=True)
limbs.walk(limbs.odometry().floor * FloorPose(-1.0, 0.0, 0.0))
time.sleep(60)
