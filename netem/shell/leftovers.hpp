// Ends whatever a program has left behind: its children, also those that have cut themselves off.
#pragma once

#include <sys/types.h>
#include <vector>

namespace thimble {

// From now on orphans below this process become its children.
void adopt_orphans();

// To all processes below this one but `spared`.
void signal_descendants(int number, pid_t spared);

// All processes below this one but `spared`: first SIGTERM, after a second SIGKILL, until there are none.
void end_descendants(pid_t spared);

}  // namespace thimble
