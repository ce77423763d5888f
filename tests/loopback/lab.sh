#!/bin/sh
# lab.sh FOLDER COMMAND...: runs the command in the namespace "operator" of a laboratory: operator, network, robot and
# display, 10.77.0.1 to 10.77.0.4, on one bridge. The namespaces have names in a mount namespace of this process alone, so
# all of it is gone when the last process in it is, however that ends. Once FOLDER/cut is there, the robot's wire is cut
# for a second; FOLDER/mended then says that it is whole again.
#
# To be started as: unshare [-Ur] -nm --propagation private sh lab.sh FOLDER COMMAND...
set -e
folder=$1
shift
mount -t tmpfs none /run
mkdir /run/netns
ip link add bridge0 type bridge
ip link set bridge0 up
number=1
for name in operator network robot display; do
    ip netns add $name
    ip link add eth0 netns $name type veth peer name $name
    ip link set $name master bridge0 up
    ip -n $name addr add 10.77.0.$number/24 dev eth0
    ip -n $name link set lo up
    ip -n $name link set eth0 up
    number=$((number + 1))
done
: >"$folder/built"
[ $# -gt 0 ] || exit 0
# The bridge lives in the namespace of this subshell, and no longer.
(
    while kill -0 $$ 2>/dev/null; do
        sleep 0.05
        if [ -e "$folder/cut" ] && [ ! -e "$folder/mended" ]; then
            ip link set robot down
            sleep 1
            ip link set robot up
            : >"$folder/mended"
        fi
    done
) &
exec ip netns exec operator "$@"
