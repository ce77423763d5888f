// tell_demonstration BASE_PORT SECONDS: a session for pictures and frame times of the experimenter's view (docs).
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "common/runtime/wall_clock.hpp"
#include "tests/views/fake_session.hpp"

int main(int argc, char** argv) {
    using namespace thimble;
    unsigned base_port = 0, seconds = 0;
    const auto number = [](const char* word, unsigned& value) {
        const char* end = word + std::strlen(word);
        return std::from_chars(word, end, value).ptr == end;
    };
    if (argc != 3 || !number(argv[1], base_port) || base_port > 65000 || !number(argv[2], seconds)) {
        std::fprintf(stderr, "usage: tell_demonstration BASE_PORT SECONDS\n");
        return 2;
    }
    const FakeSession session(static_cast<std::uint16_t>(base_port), system_entropy(), 0);
    wall_sleep(std::chrono::seconds{seconds});
    return 0;
}
