#include "visual_node/window/image.hpp"

#include <cassert>
#include <png.h>
#include <system_error>

#include "common/error.hpp"

namespace thimble {
namespace {

png_image header(int width, int height) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(width);
    png.height = static_cast<png_uint_32>(height);
    png.format = PNG_FORMAT_RGB;
    return png;
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
    assert(image.width > 0 && image.height > 0 && image.rgb.size() == 3U * image.width * image.height);
    png_image png = header(image.width, image.height);
    const std::filesystem::path part = path.string() + ".part";
    std::error_code failed;
    if (png_image_write_to_file(&png, part.c_str(), 0, image.rgb.data(), 0, nullptr) != 0) {
        std::filesystem::rename(part, path, failed);
        if (!failed) return;
    }
    const std::string why = failed ? failed.message() : std::string(png.message);
    std::filesystem::remove(part, failed);
    throw Error(ExitCode::kData, "cannot write the picture '{}' ({}): does its folder exist?", path.string(),
                why);
}

Image read_png(const std::filesystem::path& path) {
    png_image png = header(0, 0);
    Image image;
    if (png_image_begin_read_from_file(&png, path.c_str()) != 0) {
        png.format = PNG_FORMAT_RGB;
        image.width = static_cast<int>(png.width);
        image.height = static_cast<int>(png.height);
        image.rgb.resize(PNG_IMAGE_SIZE(png));
        if (png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) != 0) return image;
    }
    const std::string why = png.message;
    png_image_free(&png);
    throw Error(ExitCode::kData, "cannot read the picture '{}': {}", path.string(), why);
}

}  // namespace thimble
