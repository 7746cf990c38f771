"""A relay and input module: pymodbus serves one block of bits, in which the first 64 are coils and the next inputs.
`module.py PORT [LINK]`: by TCP, and by RTU at a serial line that has this link to it."""
import asyncio
import os
import pty
import sys
import threading
import tty

from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice


def line(link):
    """Two pseudo-terminals and what carries between them: the one for the server, the other at the link."""
    ends = [pty.openpty() for _ in range(2)]
    for _, slave in ends:
        tty.setraw(slave)

    def carry(source, sink):
        while True:
            os.write(sink, os.read(source, 4096))

    (one, _), (other, _) = ends
    for way in (one, other), (other, one):
        threading.Thread(target=carry, args=way, daemon=True).start()
    os.symlink(os.ttyname(ends[1][1]), link)
    return os.ttyname(ends[0][1])


async def main():
    bits = SimData(0, count=16, values=0, datatype=DataType.REGISTERS)
    device = SimDevice(id=1, simdata=[bits], use_bit_addressing=True)
    server = ModbusTcpServer(device, address=("127.0.0.1", int(sys.argv[1])))
    if len(sys.argv) > 2:
        # One block for both: what the one is told, the other tells.
        serial = ModbusSerialServer(device, port=line(sys.argv[2]), baudrate=115200)
        serial.context = server.context
        await asyncio.gather(server.serve_forever(), serial.serve_forever())
    await server.serve_forever()


asyncio.run(main())
