"""Makes the sound logs that fuzzing spoils: `python3 hil-tests/corpus/make_logs.py`.

Each is two seconds of a drone that rocks in hover, as its autopilot would have logged it. No log of anybody's
flight is needed in the repository, and every part of a format that a reader knows is in one of them.
"""

import gzip
import math
import pathlib
import struct

HERE = pathlib.Path(__file__).parent
G = 9.80665


def write(folder, name, content):
    (HERE / folder).mkdir(exist_ok=True)
    (HERE / folder / name).write_bytes(content)


def rates(at_s):
    """Angular rates of the body, rad/s."""
    return [0.3 * math.sin(5 * at_s), 0.2 * math.cos(4 * at_s), 0.1]


def forces(at_s):
    """Specific force of the body, forward, right and down, m/s2."""
    return [0.5 * math.sin(3 * at_s), 0.4 * math.cos(2 * at_s), -G + 0.3 * math.sin(20 * at_s)]


def motor(number, at_s):
    """A motor's command, 0 to 1."""
    return 0.5 + 0.1 * math.sin(7 * at_s + number)


# Blackbox


def unsigned(value):
    out = b""
    while value > 127:
        out += bytes([value & 127 | 128])
        value >>= 7
    return out + bytes([value])


def signed(value):
    return unsigned(value << 1 if value >= 0 else ((-value) << 1) - 1)


def tag2_3s32(values):
    if all(-2 <= value <= 1 for value in values):
        return bytes([sum((value & 3) << 4 - 2 * at for at, value in enumerate(values))])
    out, tag = b"", 0xC0
    for at, value in enumerate(values):
        size = next(size for size in (1, 2, 3, 4) if -(1 << 8 * size - 1) <= value < 1 << 8 * size - 1)
        tag |= size - 1 << 2 * at
        out += value.to_bytes(4, "little", signed=True)[:size]
    return bytes([tag]) + out


def tag8_8svb(values):
    tag = sum(1 << at for at, value in enumerate(values) if value)
    return bytes([tag]) + b"".join(signed(value) for value in values if value)


def blackbox():
    names = ["loopIteration", "time", "axisP[0]"]
    names += [f"setpoint[{axis}]" for axis in range(4)]
    names += [f"gyroADC[{axis}]" for axis in range(3)] + [f"accSmooth[{axis}]" for axis in range(3)]
    names += [f"motor[{number}]" for number in range(4)]
    row = lambda *values: ",".join(str(value) for value in values)
    lines = [
        ("Product", "Blackbox flight data recorder by Nicholas Sherlock"),
        ("Data version", "2"),
        ("I interval", "32"),
        ("P interval", "1/1"),
        ("Field I name", row(*names)),
        ("Field I signed", row(0, 0, *[1] * 11, *[0] * 4)),
        ("Field I predictor", row(0, 0, *[0] * 11, 11, 5, 5, 5)),
        ("Field I encoding", row(1, 1, *[0] * 11, 1, 0, 0, 0)),
        ("Field P predictor", row(6, 2, 1, *[1] * 4, *[1] * 3, *[3] * 3, *[3] * 4)),
        ("Field P encoding", row(9, 0, 0, *[6] * 4, *[7] * 3, *[0] * 3, *[6] * 4)),
        ("Field S name", "flightModeFlags,stateFlags,failsafePhase,rxSignalReceived,rxFlightChannelsValid"),
        ("Field S signed", "0,0,0,0,0"),
        ("Field S predictor", "0,0,0,0,0"),
        ("Field S encoding", "1,1,7,7,7"),
        ("Firmware type", "Cleanflight"),
        ("Firmware revision", "Betaflight 4.5.1 (00000000) STM32F405"),
        ("Craft name", "Rocking"),
        ("gyro_scale", "0x3f800000"),
        ("acc_1G", "2048"),
        ("motorOutput", "48,2047"),
        ("minthrottle", "1070"),
    ]
    out = b"".join(f"H {key}:{value}\n".encode() for key, value in lines)
    history = []
    for loop in range(500):
        at_s = loop * 0.004
        turn, force = rates(at_s), forces(at_s)
        # Of a body whose axes point forward, left and up.
        gyro = [turn[0], -turn[1], -turn[2]]
        accel = [force[0], -force[1], -force[2]]
        values = [loop, 1_000_000 + 4000 * loop, loop % 3]
        values += [round(math.degrees(rate)) for rate in gyro] + [round(1000 * motor(1, at_s))]
        values += [round(math.degrees(rate)) for rate in gyro]
        values += [round(force / G * 2048) for force in accel]
        values += [48 + round(1999 * motor(number, at_s)) for number in range(4)]
        if loop % 32 == 0:
            if loop % 64 == 0:
                out += b"S" + bytes([1, 0]) + tag2_3s32([0, 1, 1])
            out += b"I" + unsigned(values[0]) + unsigned(values[1])
            out += b"".join(signed(value) for value in values[2:13]) + unsigned(values[13] - 48)
            out += b"".join(signed(value - values[13]) for value in values[14:])
            history = [values, values]
        else:
            one, two = history[-1], history[-2]
            average = [int((a + b) / 2) for a, b in zip(one, two)]
            out += b"P" + signed(values[1] - (2 * one[1] - two[1])) + signed(values[2] - one[2])
            out += tag8_8svb([a - b for a, b in zip(values[3:7], one[3:7])])
            out += tag2_3s32([a - b for a, b in zip(values[7:10], one[7:10])])
            out += b"".join(signed(a - b) for a, b in zip(values[10:13], average[10:13]))
            out += tag8_8svb([a - b for a, b in zip(values[13:], average[13:])])
            history = [one, values]
    return out + b"E\xffEnd of log\x00"


# DataFlash

KINDS = {
    "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns"),
    "PARM": (129, "QNf", "TimeUS,Name,Value"),
    "MSG": (130, "QZ", "TimeUS,Message"),
    "IMU": (131, "QffffffB", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,GH"),
    "MAG": (132, "Qhhh", "TimeUS,MagX,MagY,MagZ"),
    "RCOU": (133, "QHHHH", "TimeUS,C1,C2,C3,C4"),
    "ATT": (134, "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw"),
    "RATE": (135, "Qfffffff", "TimeUS,RDes,R,PDes,P,YDes,Y,AOut"),
    "CTUN": (136, "Qff", "TimeUS,ThI,ThO"),
    "ARM": (137, "QBH", "TimeUS,ArmState,ArmChecks"),
    "EV": (138, "QB", "TimeUS,Id"),
    "DSF": (139, "QIH", "TimeUS,Dp,Blk"),
}
PACKED = {"Q": "Q", "B": "B", "H": "H", "h": "h", "I": "I", "f": "f", "c": "h", "C": "H", "n": "4s", "N": "16s", "Z": "64s"}


def message(name, *values):
    number, letters, _ = KINDS[name]
    values = [value.encode() if isinstance(value, str) else value for value in values]
    return bytes([0xA3, 0x95, number]) + struct.pack("<" + "".join(PACKED[it] for it in letters), *values)


def dataflash():
    out = b""
    for name, (number, letters, columns) in KINDS.items():
        length = 3 + struct.calcsize("<" + "".join(PACKED[it] for it in letters))
        out += message("FMT", number, length, name, letters, columns)
    out += message("MSG", 1000, "ArduCopter V4.5.7 (00000000)")
    for name, value in [("FRAME_CLASS", 1), ("MOT_PWM_MIN", 1000), ("MOT_PWM_MAX", 2000), *[(f"SERVO{it + 1}_FUNCTION", 33 + it) for it in range(4)]]:
        out += message("PARM", 2000, name, value)
    out += message("ARM", 1_000_000, 1, 0) + message("EV", 1_100_000, 28)
    for step in range(100):
        at_us, at_s = 1_000_000 + 20_000 * step, 0.02 * step
        turn, force = rates(at_s), forces(at_s)
        out += message("IMU", at_us, *turn, *force, 1)
        if step % 5 == 0:
            out += message("MAG", at_us, 210, 5, 420)
            out += message("RCOU", at_us, *[1000 + round(1000 * motor(number, at_s)) for number in range(4)])
            out += message("ATT", at_us, 100, 90, -50, -40, 9000, 8990)
            out += message("RATE", at_us, *[math.degrees(turn[0])] * 2, *[math.degrees(turn[1])] * 2, 5.7, 5.7, 0.5)
            out += message("CTUN", at_us, 0.5, 0.5)
    out += message("DSF", 3_000_000, 2, 7) + message("EV", 3_000_000, 18) + message("ARM", 3_000_000, 0, 0)
    return out


# A Crazyflie's card


def usd():
    names = ["gyro.x", "gyro.y", "gyro.z", "acc.x", "acc.y", "acc.z"]
    out = bytes([0xBC, 2, 0, 1, 0, 7, 0]) + b"fixedFrequency\0" + struct.pack("<H", len(names) + 4)
    out += b"".join(f"{name}(f)\0".encode() for name in names)
    out += b"".join(f"motor.m{number}(H)\0".encode() for number in range(1, 5))
    for step in range(200):
        at_s = 0.01 * step
        turn, force = rates(at_s), forces(at_s)
        gyro = [math.degrees(turn[0]), -math.degrees(turn[1]), -math.degrees(turn[2])]
        accel = [force[0] / G, -force[1] / G, -force[2] / G]
        out += struct.pack("<HQ6f4H", 7, 10_000 * step, *gyro, *accel, *[round(65535 * motor(it, at_s)) for it in range(4)])
    return out + bytes(4)


# Columns of other writers: names, scale of the time, of rates and of forces


WRITERS = {
    "blackbox_decode": ("loopIteration,time (us),gyroADC[0] (deg/s),gyroADC[1] (deg/s),gyroADC[2] (deg/s),"
                        "accSmooth[0] (g),accSmooth[1] (g),accSmooth[2] (g),motor[0],motor[1],motor[2],motor[3]",
                        1e6, math.degrees(1), 1 / G),
    "ulog2csv": ("timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,accelerometer_timestamp_relative,"
                 "accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2]", 1e6, 1, 1),
    "euroc": ("#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
              "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]", 1e9, 1, 1),
    "crazyflie": ("timestamp,gyro.x,gyro.y,gyro.z,acc.x,acc.y,acc.z,motor.m1,motor.m2,motor.m3,motor.m4",
                  1e3, math.degrees(1), 1 / G),
    "mavlogdump": ("timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T", 1, 1, 1),
}


def columns(header, time, turn_unit, force_unit):
    out = header + "\n"
    for step in range(120):
        at_s = 0.02 * step
        turn = [rate * turn_unit for rate in rates(at_s)]
        force = [value * force_unit for value in forces(at_s)]
        cells = []
        for name in header.lower().split(","):
            axis = next((axis for axis in range(3) if f"[{axis}]" in name or "xyz"[axis] in name.split(" ")[0][-1]), 0)
            if "time" in name and "relative" not in name:
                cells.append(round(at_s * (1e6 if name == "timeus" else time), 3))
            elif name.startswith("motor"):
                cells.append(round(1000 + 1000 * motor(axis, at_s)) if "[" in name else round(65535 * motor(axis, at_s)))
            elif "gyr" in name and "dt" not in name or "w_rs" in name:
                cells.append(f"{turn[axis]:.5f}")
            elif "acc" in name and "relative" not in name or "a_rs" in name:
                cells.append(f"{force[axis]:.5f}")
            else:
                cells.append(step)
        out += ",".join(str(cell) for cell in cells) + "\n"
    return out.encode()


write("blackbox", "rocking.bbl", blackbox())
write("dataflash", "rocking.bin", dataflash())
write("usd", "rocking.usd", usd())
for writer, (header, *units) in WRITERS.items():
    write("csv", f"{writer}.csv", columns(header, *units))
write("packed", "rocking.usd.gz", gzip.compress(usd(), mtime=0))
