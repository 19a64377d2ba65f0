"""PORT COUNT FRAMES: reads COUNT tags of the reader on PORT with llrpkit's client; prints them as JSON."""
import asyncio
import json
import sys

from llrpkit.reader import Reader

from llrp_tap import Tap


async def session(port, count):
    tags = []
    async with Reader("127.0.0.1", port) as reader:
        async for tag in reader.inventory(include_phase=True, include_doppler=True, search_mode=2, mode_index=2,
                                          max_tags=count, duration=20):
            tags.append([tag.epc_hex.upper(), round(tag.phase_deg * 4096 / 360), tag.antenna, tag.channel_index,
                         round(tag.rssi_dbm * 100), tag.first_seen_us])
    return tags


tap = Tap("127.0.0.1", int(sys.argv[1]))
print(json.dumps(asyncio.run(session(tap.port, int(sys.argv[2])))))
tap.write(sys.argv[3])
