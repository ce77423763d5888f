# Debian 12 packages only; deploy/packages.txt names them.
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(FlatBuffers REQUIRED)
find_package(ZLIB REQUIRED)
find_program(FLATC_EXECUTABLE flatc REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(libsodium REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(pcap REQUIRED IMPORTED_TARGET libpcap)

# What windows need. Without it every program still runs, with displays that only record.
option(THIMBLE_GUI "build windows and thimble play" ON)
if(THIMBLE_GUI)
    find_package(glfw3 3.3 REQUIRED)
    find_package(PNG REQUIRED)
    pkg_check_modules(epoxy REQUIRED IMPORTED_TARGET epoxy)
    pkg_check_modules(imgui REQUIRED IMPORTED_TARGET imgui)
endif()

# Sound in those windows. Without it the beep is shown only.
option(THIMBLE_AUDIO "build the beep (with THIMBLE_GUI)" ON)
if(THIMBLE_GUI AND THIMBLE_AUDIO)
    pkg_check_modules(openal REQUIRED openal)
endif()

# Real devices on USB: HID, and the Novint Falcon. Force Dimension's library is opened at run time and needs nothing here. Without
# it every program still runs, with simulated devices.
option(THIMBLE_DEVICES "build what talks to real devices" ON)
if(THIMBLE_DEVICES)
    pkg_check_modules(hidapi REQUIRED IMPORTED_TARGET hidapi-hidraw)
    pkg_check_modules(libusb REQUIRED IMPORTED_TARGET libusb-1.0)
endif()

# Work by the ranks of many machines: a module, so that no program needs Open MPI.
option(THIMBLE_MPI "build thimble-ranks.so, for mpirun" ON)
if(THIMBLE_SANITIZE)
    set(THIMBLE_MPI OFF)  # what Open MPI itself leaks and races would be all they say
endif()
if(THIMBLE_MPI)
    pkg_check_modules(ompi REQUIRED IMPORTED_TARGET ompi-c)
endif()

# OpenIGTLink, for thimble-igtl alone (docs/interoperability.md). Its own CMake files would change the flags of everything.
option(THIMBLE_IGTL "build thimble-igtl, which shows sessions to 3D Slicer" ON)
if(THIMBLE_IGTL)
    find_path(OPENIGTLINK_INCLUDE_DIR igtlTransformMessage.h PATH_SUFFIXES openigtlink REQUIRED)
    find_library(OPENIGTLINK_LIBRARY OpenIGTLink REQUIRED)
    add_library(openigtlink INTERFACE IMPORTED)
    target_include_directories(openigtlink INTERFACE ${OPENIGTLINK_INCLUDE_DIR})
    target_link_libraries(openigtlink INTERFACE ${OPENIGTLINK_LIBRARY})
endif()

# import thimble (docs/python.md). Sanitizers would have to be loaded into Python before it.
option(THIMBLE_PYTHON "build the Python package" ON)
if(THIMBLE_PYTHON AND THIMBLE_SANITIZE)
    set(THIMBLE_PYTHON OFF)
endif()
if(THIMBLE_PYTHON)
    set(Python_FIND_STRATEGY LOCATION)  # the first python3 of the PATH, not the newest
    find_package(Python 3.11 COMPONENTS Interpreter Development.Module)
    find_package(pybind11 2.10 CONFIG)
    if(NOT Python_Development.Module_FOUND OR NOT pybind11_FOUND)
        message(WARNING "THIMBLE_PYTHON is off: the headers of Python or pybind11 are not here (packages python3-dev, pybind11-dev)")
        set(THIMBLE_PYTHON OFF)
    endif()
endif()

# Cyclone DDS, for the programs thimble-ros2* alone (docs/ros2.md). Its idlc makes C of the messages.
option(THIMBLE_ROS2 "build thimble-ros2, which shows sessions to ROS 2" ON)
if(THIMBLE_SANITIZE)
    set(THIMBLE_ROS2 OFF)  # as with Open MPI: DDS has threads of its own, and no sanitizer in them
endif()
if(THIMBLE_ROS2)
    find_package(CycloneDDS REQUIRED)
    enable_language(C)
endif()
