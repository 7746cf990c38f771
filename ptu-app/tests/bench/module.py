"""A relay and input module: pymodbus serves one block of bits, in which the first 64 are coils and the next inputs."""
import asyncio
import sys

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice


async def main():
    bits = SimData(0, count=16, values=0, datatype=DataType.REGISTERS)
    device = SimDevice(id=1, simdata=[bits], use_bit_addressing=True)
    server = ModbusTcpServer(device, address=("127.0.0.1", int(sys.argv[1])))
    await server.serve_forever()


asyncio.run(main())
