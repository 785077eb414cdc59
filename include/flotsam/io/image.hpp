#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace flotsam {

/// Red, green, blue bytes (sRGB), row by row from the top left.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb; ///< 3 width height

    Image() = default;
    /// Black. Throws std::invalid_argument unless both are from 1 to 16384.
    Image(int width_pixels, int height_pixels);

    [[nodiscard]] std::uint8_t* pixel(std::size_t index) { return rgb.data() + 3 * index; }
    [[nodiscard]] const std::uint8_t* pixel(std::size_t index) const { return rgb.data() + 3 * index; }
};

/// The bytes of a PNG file. Throws OutputError; std::invalid_argument for an empty image.
[[nodiscard]] std::vector<std::uint8_t> png_of(const Image& image);

/// Throws OutputError; std::invalid_argument for an empty image.
void write_png(const std::filesystem::path& file, const Image& image);

} // namespace flotsam
