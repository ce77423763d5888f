#!/bin/sh
# fake_ssh.sh ROOM HOST COMMAND...: stands in for ssh. Runs the command in a session of its own, through a login shell,
# connected to the caller by pipes alone; its temporary files go to ROOM. Some hosts are out of order.
room=$1 host=$2
shift 2
case $host in
    down) echo "ssh: connect to host $host port 22: Connection refused" >&2; exit 255 ;;
    mute) exec sleep 60 ;;
    flooding) exec yes "Welcome to $host" ;;
    trickling)  # a log that is never whole
        HOST=$host TMPDIR=$room setsid -w sh -c "$*" | sed -u 's/^\(thimble: ended [0-9]*\) .*/\1 100000000/'
        while sleep 0.1; do echo more; done
        ;;
    chatty) echo "Welcome to $host" ;;
    breaking)
        exec 4<&0  # what runs in the background gets no other input by itself
        HOST=$host TMPDIR=$room setsid sh -c "$*" <&4 4<&- &
        until [ -e "$room/../break" ]; do
            kill -0 $! 2>/dev/null || exit 0
            sleep 0.05
        done
        echo "client_loop: send disconnect: Broken pipe" >&2
        exit 255
        ;;
esac
HOST=$host TMPDIR=$room exec setsid -w sh -c "$*"
