"""Samples of a log as an independent reader reads them: `peers.py KIND FILE`.

Prints a line for each sample: time in microseconds, three rates, three forces, in the log's units.
"""
import sys

kind, file = sys.argv[1:]
if kind == "pyulog":
    from pyulog import ULog

    data = ULog(file, ["sensor_combined"]).get_dataset("sensor_combined").data
    names = [f"gyro_rad[{i}]" for i in range(3)] + [f"accelerometer_m_s2[{i}]" for i in range(3)]
    rows = zip(data["timestamp"], *(data[name] for name in names))
elif kind == "orangebox":
    from orangebox import Parser

    log = Parser.load(file)
    gyro = "gyroUnfilt" if "gyroUnfilt[0]" in log.field_names else "gyroADC"
    names = ["time"] + [f"{name}[{i}]" for name in (gyro, "accSmooth") for i in range(3)]
    columns = [log.field_names.index(name) for name in names]
    rows = ([frame.data[column] for column in columns] for frame in log.frames())
elif kind == "pymavlink":
    from pymavlink import mavutil

    log = mavutil.mavlink_connection(file)
    messages = iter(lambda: log.recv_match(type="IMU"), None)
    rows = (
        (m.TimeMS * 1000, m.GyrX, m.GyrY, m.GyrZ, m.AccX, m.AccY, m.AccZ) for m in messages
    )
for row in rows:
    print(*(repr(float(value)) for value in row))
