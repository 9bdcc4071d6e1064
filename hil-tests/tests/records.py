"""Rows of a flight log as an independent reader reads them: `records.py FILE`.

Prints a line for each row: topic, microseconds, numbers. What follows the last whole row of a log that
is cut off is left out.
"""
import math
import sys


def numbers(value):
    """A field of a protobuf message as numbers."""
    if hasattr(value, "DESCRIPTOR"):
        return [n for field in value.DESCRIPTOR.fields for n in numbers(getattr(value, field.name))]
    if isinstance(value, (str, bytes)):
        return []
    return [float(n) for n in value] if hasattr(value, "__len__") else [float(value)]


def mcap_rows(file):
    from mcap.exceptions import EndOfFile
    from mcap.reader import NonSeekingReader
    from mcap_protobuf.decoder import DecoderFactory

    with open(file, "rb") as stream:
        reader = NonSeekingReader(stream, decoder_factories=[DecoderFactory()])
        try:
            # In the order of the file: sorting would want its end.
            for _, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
                yield channel.topic, message.log_time // 1000, numbers(decoded)
        except EndOfFile:
            return


def ulog_rows(file):
    from pyulog import ULog

    for dataset in ULog(file).data_list:
        names = [field.field_name for field in dataset.field_data if field.field_name != "timestamp"]
        columns = [dataset.data[name] for name in names]
        for place, time in enumerate(dataset.data["timestamp"]):
            row = [float(column[place]) for column in columns]
            if dataset.name == "actuator_motors":
                row = [share for share in row if not math.isnan(share)]
            yield dataset.name, int(time), row


file = sys.argv[1]
for topic, time, row in (mcap_rows if file.endswith(".mcap") else ulog_rows)(file):
    print(topic, time, *map(repr, row))
