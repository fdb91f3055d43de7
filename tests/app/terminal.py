# SPDX-License-Identifier: Apache-2.0
"""What a command prints of its progress on a terminal: one line that is
rewritten, and ended before anything else is said.

usage: terminal.py WORDS COMMAND...: WORDS stand in the last state of the line;
prints how many states it had.
"""
import os
import pty
import sys


def talk(command):
    """What the command writes to a terminal that is its standard error; its
    exit status."""
    child, end = pty.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.execv(command[0], command)
    said = b''
    while True:
        try:
            piece = os.read(end, 4096)
        except OSError:  # the terminal's other end is closed
            break
        if not piece:
            break
        said += piece
    return said, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def main():
    words, command = sys.argv[1].encode(), sys.argv[2:]
    said, status = talk(command)
    assert status == 0, (status, said)
    assert said.endswith(b'\r\n'), said  # a terminal makes CR LF of LF
    line, rest = said[:-2], said[-2:]
    assert b'\n' not in line and rest.count(b'\n') == 1, said
    states = line.split(b'\r')
    assert states[0] == b'' and len(states) > 1, said
    for state in states[1:]:
        assert state.startswith(b'[') and state.endswith(b'\033[K'), state
    last = states[-1]
    assert last.startswith(b'[####################] ') and words in last, last
    assert b'  ETA 0:00\033' in last, last
    print(len(states) - 1)


main()
