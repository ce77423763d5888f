// The studies of thimble-bench. Each takes its own command line, from its name on.
#pragma once

namespace thimble {

int chain_study(int argc, char** argv);           // chain_study.cpp
int flood_study(int argc, char** argv);           // flood_study.cpp
int network_study(int argc, char** argv);         // network_study.cpp
int scene_cost_study(int argc, char** argv);      // scene_cost_study.cpp
int stability_study(int argc, char** argv);       // stability_study.cpp
int velocity_study(int argc, char** argv);        // velocity_study.cpp
int work_precision_study(int argc, char** argv);  // work_precision.cpp

}  // namespace thimble
