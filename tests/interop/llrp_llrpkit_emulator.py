"""FRAMES: llrpkit's emulated reader behind a tap. Prints the port; ends, and writes the frames, when stdin does."""
import asyncio
import sys

from llrpkit.emulator import LLRPEmulator

from llrp_tap import Tap


async def emulate():
    async with LLRPEmulator(reads_per_sec=200.0, seed=7) as emulator:
        tap = Tap("127.0.0.1", emulator.port)
        print(tap.port, flush=True)
        await asyncio.get_running_loop().run_in_executor(None, sys.stdin.read)
        tap.write(sys.argv[1])


asyncio.run(emulate())
