#include "flotsam/io/image.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_error.hpp"
#include "io/output_file.hpp"

#include <png.h>

namespace flotsam {

Image::Image(int width_pixels, int height_pixels) : width(width_pixels), height(height_pixels)
{
    require(width >= 1 && width <= 16384, "the width of a picture must be from 1 to 16384 pixels", width);
    require(height >= 1 && height <= 16384, "the height of a picture must be from 1 to 16384 pixels", height);
    rgb.resize(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

std::vector<std::uint8_t> png_of(const Image& image)
{
    require(!image.rgb.empty(), "a picture must have pixels to be written");
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png.flags = PNG_IMAGE_FLAG_FAST; // a quarter of the time, and files a tenth larger
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::uint8_t> encoded(bytes);
    if (png_image_write_to_memory(&png, encoded.data(), &bytes, 0, image.rgb.data(), 0, nullptr) == 0)
        throw OutputError(std::string("a picture cannot be encoded: ") + png.message);
    encoded.resize(bytes);
    return encoded;
}

void write_png(const std::filesystem::path& file, const Image& image)
{
    // Encoded in memory first: libpng's own file writing does not report a disk that is full at close.
    const std::vector<std::uint8_t> encoded = png_of(image);
    OutputFile stream(file);
    stream.write(encoded.data(), encoded.size());
    stream.close();
}

} // namespace flotsam
