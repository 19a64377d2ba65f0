"""FRAMES PCAP: decodes and re-encodes every frame with llrpkit, reports with pyllrp too; prints what differs.
Writes the frames as a capture of TCP port 5084 for tshark."""
import json
import struct
import sys

import bitstring
from llrpkit.protocol import decode_message
from pyllrp.pyllrp import UnpackMessage

RO_ACCESS_REPORT = 61
frames = [(who, bytes.fromhex(text)) for who, text in json.load(open(sys.argv[1]))]
counts = {"client": 0, "reader": 0, "reports": 0}
for who, frame in frames:
    counts[who] += 1
    again = decode_message(frame).to_bytes()
    if again != frame:
        print("llrpkit differs:", frame.hex(), again.hex())
    if int.from_bytes(frame[:2], "big") & 0x3FF == RO_ACCESS_REPORT:
        counts["reports"] += 1
        message = UnpackMessage(bitstring.ConstBitStream(bytes=frame))
        again = message.pack(bitstring.BitStream()).tobytes()
        if again != frame:
            print("pyllrp differs:", frame.hex(), again.hex())

CLIENT, READER = (bytes([127, 0, 0, 1]), 40000), (bytes([127, 0, 0, 2]), 5084)
with open(sys.argv[2], "wb") as pcap:
    pcap.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 0x40000, 101))  # raw IP
    sequence = {"client": 1, "reader": 1}
    for index, (who, frame) in enumerate(frames):
        source, sink = (CLIENT, READER) if who == "client" else (READER, CLIENT)
        other = "reader" if who == "client" else "client"
        for at in range(0, len(frame), 1400):
            part = frame[at:at + 1400]
            tcp = struct.pack(">HHIIBBHHH", source[1], sink[1], sequence[who], sequence[other], 5 << 4, 0x18, 65535, 0, 0)
            ip = struct.pack(">BBHHHBBH", 0x45, 0, 40 + len(part), index & 0xFFFF, 0, 64, 6, 0) + source[0] + sink[0]
            packet = ip + tcp + part
            pcap.write(struct.pack("<IIII", index, 0, len(packet), len(packet)) + packet)
            sequence[who] += len(part)
print(json.dumps(counts))
