#include "tests/devices/mock_bed.hpp"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <unistd.h>

namespace thimble {
namespace {

void throw_if(GError* error) {
    if (error == nullptr) return;
    const std::string words = error->message;
    g_error_free(error);
    throw std::runtime_error("umockdev: " + words);
}

}  // namespace

// umockdev_in_mock_environment() says no before the first bed is made.
bool MockBed::possible() {
    const char* const preloaded =
        std::getenv("LD_PRELOAD");  // NOLINT(concurrency-mt-unsafe): no thread sets it
    return preloaded != nullptr && std::strstr(preloaded, "libumockdev-preload") != nullptr;
}

MockBed::MockBed() : testbed_(umockdev_testbed_new()) {}
MockBed::~MockBed() { g_object_unref(testbed_); }

void MockBed::add(const std::string& description) {
    GError* error = nullptr;
    umockdev_testbed_add_from_string(testbed_, description.c_str(), &error);
    throw_if(error);
}

void MockBed::answer(const std::string& file, UMockdevIoctlBase* handler) {
    GError* error = nullptr;
    umockdev_testbed_attach_ioctl(testbed_, file.c_str(), handler, &error);
    throw_if(error);
}

void MockBed::ignore(const std::string& file) {
    umockdev_testbed_detach_ioctl(testbed_, file.c_str(), nullptr);
}

std::string MockBed::vacate(const std::string& file) {
    gchar* const root = umockdev_testbed_get_root_dir(testbed_);
    const std::string there = root + file;
    g_free(root);
    unlink(there.c_str());
    return there;
}

}  // namespace thimble
