// The studies of thimble-bench. Each takes its own command line, from its name on.
#pragma once

namespace thimble {

int network_study(int argc, char** argv);         // network_study.cpp
int network_ends(int argc, char** argv);          // network_ends.cpp
int codec_study(int argc, char** argv);           // codec_study.cpp
int stability_study(int argc, char** argv);       // stability_study.cpp
int work_precision_study(int argc, char** argv);  // work_precision.cpp

}  // namespace thimble
