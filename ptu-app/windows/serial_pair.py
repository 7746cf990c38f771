"""Two pseudo-terminals joined like a null modem cable: prints their names and carries bytes until it is ended."""

import os
import pty
import select
import sys
import tty

(near, near_name), (far, far_name) = [
    (master, os.ttyname(slave)) for master, slave in (pty.openpty(), pty.openpty()) if tty.setraw(slave) or True
]
print(near_name, far_name)
sys.stdout.flush()
to = {near: far, far: near}
while True:
    for end in select.select(list(to), [], [])[0]:
        os.write(to[end], os.read(end, 4096))
