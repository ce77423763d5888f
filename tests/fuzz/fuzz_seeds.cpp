// fuzz_seeds DIRECTORY: writes one valid packet of each kind, for fuzz_decode to start from.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/codec.hpp"
#include "tests/fuzz/packets.hpp"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: fuzz_seeds DIRECTORY\n", stderr);
        return 2;
    }
    const std::filesystem::path directory = argv[1];
    std::filesystem::create_directories(directory);
    thimble::Encoder encoder;
    for (const thimble::Message& message : thimble::sample_messages()) {
        const thimble::Bytes bytes = encoder.encode(message);
        std::ofstream file(directory / ("packet_" + std::to_string(message.body.index())), std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        if (!file.flush()) {
            std::fprintf(stderr, "fuzz_seeds: cannot write to %s\n", directory.c_str());
            return 1;
        }
    }
    return 0;
}
