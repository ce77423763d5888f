// `thimble-visual --view experimenter`: a window of its own, which hears the session and asks it, and is no node of it: it
// may come and go while the session runs, and sessions may come and go while it runs.
#pragma once

namespace thimble {

// Whether the command line asks for this view, before it is parsed.
bool asks_for_experimenter_view(int argc, char** argv);

// Until the window is closed, SIGINT or SIGTERM; returns the exit code.
int run_experimenter_view(int argc, char** argv);

}  // namespace thimble
