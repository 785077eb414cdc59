#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace flotsam {

/// One DataArray of a .vtp; borrows its values.
struct VtpArray {
    std::string_view type; ///< "Float32", ...
    std::string_view name;
    int components = 1;
    const void* data = nullptr;
    std::size_t bytes = 0;
};

template <class T>
VtpArray vtp_array(std::string_view name, const std::vector<T>& values, int components = 1)
{
    static_assert(std::is_arithmetic_v<T>);
    constexpr std::string_view kKind = std::is_floating_point_v<T> ? "Float" : std::is_signed_v<T> ? "Int" : "UInt";
    static_assert(sizeof(T) == 4 || sizeof(T) == 8);
    constexpr std::string_view kType = kKind == "Float" ? (sizeof(T) == 4 ? "Float32" : "Float64")
                                       : kKind == "Int" ? (sizeof(T) == 4 ? "Int32" : "Int64")
                                                        : (sizeof(T) == 4 ? "UInt32" : "UInt64");
    return {kType, name, components, values.data(), values.size() * sizeof(T)};
}

/// The content of a .vtp with one piece. Cells are either all vertices or all polygons.
struct VtpFile {
    enum class Cells { vertices, polygons };

    std::size_t points = 0, cells = 0;
    Cells kind = Cells::vertices;
    VtpArray positions;             ///< 3 components
    VtpArray connectivity, offsets; ///< offsets: one past the end of each cell
    std::vector<VtpArray> point_data, cell_data;
    std::string_view point_scalars, point_vectors; ///< shown first; empty: none

    /// Throws OutputError.
    void write(const std::filesystem::path& file) const;
};

} // namespace flotsam
