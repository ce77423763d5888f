#include "tests/devices/mock_bed.hpp"

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

bool MockBed::possible() { return umockdev_in_mock_environment() != 0; }

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
