"""What pymavlink makes of signed frames: `peer.py sign` or `peer.py check`, frames as lines of hex."""

import sys

from pymavlink.dialects.v20 import common

KEY = b"an orange parrot on a blue drone"
STAMP = 36_000_000_000_000


def station():
    mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
    mav.robust_parsing = True
    mav.signing.secret_key = KEY
    mav.signing.link_id = 5
    mav.signing.timestamp = STAMP
    mav.signing.sign_outgoing = True
    return mav


def sign():
    """Frames of a station: alive, arm, fly, here you are, disarm."""
    mav = station()
    level, rates = [1, 0, 0, 0], (0, 0, 0)
    for message in [
        common.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3),
        common.MAVLink_command_long_message(1, 0, 400, 0, 1, 0, 0, 0, 0, 0, 0),
        common.MAVLink_set_attitude_target_message(7, 1, 1, 0, level, *rates, 0.5),
        common.MAVLink_odometry_message(
            7, 1, 1, 1, 2, -3, level, 0, 0, 0, *rates, [0] * 21, [0] * 21, 9, 0, 100
        ),
        common.MAVLink_command_int_message(1, 1, 0, 400, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    ]:
        print(message.pack(mav).hex())


def check():
    """For each frame the message's name, or BAD_DATA."""
    mav = station()
    for line in sys.stdin:
        messages = mav.parse_buffer(bytes.fromhex(line)) or []
        print(*[message.get_type() for message in messages])


{"sign": sign, "check": check}[sys.argv[1]]()
