#pragma once

#include "mesh_builder.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

/// Four file formats, little endian.
namespace meshes {

inline std::string decimals(const Point& p)
{
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "%.6f %.6f %.6f", p[0] + 0.0, p[1] + 0.0, p[2] + 0.0);
    return text.data();
}

template <class Number>
void put(std::string& bytes, Number value)
{
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &value, sizeof(Number));
    bytes.append(raw.data(), raw.size());
}

inline void put_point(std::string& bytes, const Point& p)
{
    for (const double x : p) put(bytes, static_cast<float>(x));
}

inline void save(const std::filesystem::path& file, const std::string& bytes)
{
    std::ofstream stream(file, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

inline void write_obj(const std::filesystem::path& file, const Mesh& mesh)
{
    std::string text = "# flotsam " + mesh.name + ", metres, z up\no " + mesh.name + "\n";
    for (const Point& p : mesh.vertices) text += "v " + decimals(p) + "\n";
    for (const auto& t : mesh.triangles) {
        text += "f";
        for (const int corner : t) text += " " + std::to_string(corner + 1);
        text += "\n";
    }
    save(file, text);
}

/// Binary STL shares no vertices between triangles.
inline void write_stl(const std::filesystem::path& file, const Mesh& mesh)
{
    std::string bytes = "flotsam " + mesh.name + ", metres, z up";
    bytes.resize(80, ' ');
    put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) -> const Point& {
            return mesh.vertices[static_cast<std::size_t>(t[k])];
        };
        const Point &a = corner(0), &b = corner(1), &c = corner(2);
        const Point u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        Point normal = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (double& x : normal) x = 1e-6 * static_cast<double>(std::lround(1e6 * x / length));
        put_point(bytes, normal);
        put_point(bytes, a);
        put_point(bytes, b);
        put_point(bytes, c);
        put(bytes, std::uint16_t{0});
    }
    save(file, bytes);
}

inline void write_ply(const std::filesystem::path& file, const Mesh& mesh)
{
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\ncomment flotsam " + mesh.name + ", metres, z up\n" + "element vertex " +
        std::to_string(mesh.vertices.size()) + "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
        std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Point& p : mesh.vertices) put_point(bytes, p);
    for (const auto& t : mesh.triangles) {
        put(bytes, std::uint8_t{3});
        for (const int corner : t) put(bytes, static_cast<std::int32_t>(corner));
    }
    save(file, bytes);
}

/// glTF calls its second axis up; these numbers are z up all the same, as a reader that changes nothing wants them.
inline void write_glb(const std::filesystem::path& file, const Mesh& mesh)
{
    std::string data;
    Point low = mesh.vertices[0], high = low;
    for (const Point& p : mesh.vertices) {
        put_point(data, p);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const std::size_t points = data.size();
    for (const auto& t : mesh.triangles)
        for (const int corner : t) put(data, static_cast<std::uint16_t>(corner));
    const std::size_t indices = data.size() - points;
    data.resize((data.size() + 3) / 4 * 4, '\0');

    const auto list = [](const Point& p) {
        std::string text = decimals(p);
        for (std::size_t at; (at = text.find(' ')) != std::string::npos;) text[at] = ',';
        return "[" + text + "]";
    };
    std::string json =
        R"({"asset":{"version":"2.0","generator":"flotsam make_meshes, metres, z up"},"scene":0,"scenes":[{"nodes":[0]}],)"
        R"("nodes":[{"name":")" +
        mesh.name + R"(","mesh":0}],"meshes":[{"name":")" + mesh.name +
        R"(","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
        R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
        std::to_string(mesh.vertices.size()) + R"(,"min":)" + list(low) + R"(,"max":)" + list(high) +
        R"(},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":)" +
        std::to_string(3 * mesh.triangles.size()) + R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" +
        std::to_string(points) + R"(,"target":34962},{"buffer":0,"byteOffset":)" + std::to_string(points) +
        R"(,"byteLength":)" + std::to_string(indices) + R"(,"target":34963}],"buffers":[{"byteLength":)" +
        std::to_string(data.size()) + "}]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');

    std::string bytes = "glTF";
    put(bytes, std::uint32_t{2});
    put(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + data.size()));
    put(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    put(bytes, static_cast<std::uint32_t>(data.size()));
    bytes += std::string("BIN\0", 4) + data;
    save(file, bytes);
}

} // namespace meshes
