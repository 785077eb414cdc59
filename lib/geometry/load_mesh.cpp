#include "flotsam/geometry/load_mesh.hpp"

#include "assimp_files.hpp"
#include "flotsam/core/contracts.hpp"
#include "mesh_files/mesh_files.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

namespace flotsam {

namespace {

using std::filesystem::path;

constexpr std::array<std::string_view, 6> kFormats{".obj", ".stl", ".ply", ".dae", ".gltf", ".glb"};

[[noreturn]] void refuse(const path& file, std::string reason)
{
    std::replace(reason.begin(), reason.end(), '\n', ' '); // a sentence is one line, whatever assimp says
    if (reason.size() > 400) reason.replace(400, std::string::npos, "...");
    throw InputError("cannot read mesh \"" + file.string() + "\": " + reason);
}

std::string extension_of(const path& file)
{
    std::string extension = file.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return extension;
}

std::string content_of(const path& file)
{
    std::ifstream stream(file, std::ios::binary);
    std::string content((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (!stream.is_open() || stream.bad()) refuse(file, "it cannot be opened for reading");
    return content;
}

/// Before anything is read.
void check_file(const path& file)
{
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) refuse(file, "there is no such file");
    if (!std::filesystem::is_regular_file(status)) refuse(file, "it is not a file");
    if (!is_mesh_file_name(file)) refuse(file, "its name must end in .obj, .stl, .ply, .dae, .gltf or .glb");
}

/// What assimp is to read instead of the file.
std::string plain_content(const path& file)
{
    const std::string content = content_of(file);
    if (content.empty()) refuse(file, "it is empty");
    const std::string extension = extension_of(file);
    if (extension == ".ply") return plain_ply(content);
    if (extension == ".stl") return plain_stl(content);
    if (extension == ".obj") return plain_obj(content);
    if (extension == ".dae") return plain_dae(content);
    return plain_gltf(content, file);
}

/// Appends the triangles of the scene's nodes, each placed by the nodes above it.
class SceneReader {
  public:
    SceneReader(const path& file, const aiScene& scene) : file_(file), scene_(scene) {}

    void read(const aiNode& node, const aiMatrix4x4& parent) { read_with(node, parent * node.mTransformation); }

    void read_with(const aiNode& node, const aiMatrix4x4& placement)
    {
        for (unsigned k = 0; k < node.mNumMeshes; ++k) add_part(node, *scene_.mMeshes[node.mMeshes[k]], placement);
        for (unsigned k = 0; k < node.mNumChildren; ++k) read(*node.mChildren[k], placement);
    }

    TriangleMesh mesh;
    double farthest = 0.0; ///< largest coordinate in any part's own frame, as large as the part is placed

  private:
    void add_part(const aiNode& node, const aiMesh& part, const aiMatrix4x4& placement)
    {
        if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0 || part.mNumFaces == 0) return;
        const std::string name = part.mName.length > 0 ? part.mName.C_Str() : node.mName.C_Str();
        const auto first = static_cast<int>(mesh.vertices.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v) mesh.vertices.push_back(placed(part.mVertices[v], placement));
        note_farthest(part, placement);
        for (unsigned f = 0; f < part.mNumFaces; ++f) add_triangle(name, part, f, first);
        mesh.part_of_triangle.resize(mesh.triangles.size(), static_cast<int>(mesh.part_names.size()));
        mesh.part_names.push_back(name);
    }

    void add_triangle(const std::string& name, const aiMesh& part, unsigned f, int first)
    {
        const aiFace& face = part.mFaces[f];
        const std::string place = "face " + std::to_string(f) + " of its part \"" + name + "\"";
        if (face.mNumIndices != 3)
            refuse(file_, place + " has " + std::to_string(face.mNumIndices) + " corners, at least 3 are needed");
        std::array<int, 3> triangle{};
        for (unsigned k = 0; k < 3; ++k) {
            if (face.mIndices[k] >= part.mNumVertices)
                refuse(file_, place + " names vertex " + std::to_string(face.mIndices[k]) + " of " +
                                  std::to_string(part.mNumVertices));
            triangle[k] = first + static_cast<int>(face.mIndices[k]);
        }
        mesh.triangles.push_back(triangle);
    }

    void note_farthest(const aiMesh& part, const aiMatrix4x4& m)
    {
        const double scale =
            std::sqrt(std::max({m.a1 * m.a1 + m.b1 * m.b1 + m.c1 * m.c1, m.a2 * m.a2 + m.b2 * m.b2 + m.c2 * m.c2,
                                m.a3 * m.a3 + m.b3 * m.b3 + m.c3 * m.c3}));
        for (unsigned v = 0; v < part.mNumVertices; ++v) {
            const aiVector3D& p = part.mVertices[v];
            farthest = std::max(farthest, scale * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
        }
    }

    /// In double: assimp's own product would round to float once more.
    static Vec3d placed(const aiVector3D& point, const aiMatrix4x4& m)
    {
        const Vec3d p(point.x, point.y, point.z);
        if (m == aiMatrix4x4()) return p; // a product would spread a NaN, which check_mesh names, to all three
        return {Vec3d(m.a1, m.a2, m.a3).dot(p) + m.a4, Vec3d(m.b1, m.b2, m.b3).dot(p) + m.b4,
                Vec3d(m.c1, m.c2, m.c3).dot(p) + m.c4};
    }

    const path& file_;
    const aiScene& scene_;
};

/// The coordinates in the file became floats; far from their origin those are too coarse for what they describe.
void check_precision(const path& file, const TriangleMesh& mesh, double farthest)
{
    constexpr double kRounding = 6e-8; // half a unit in the last place, relative
    constexpr double kAllowed = 1e-4;  // of the diagonal
    const Aabb box = bounds(mesh);
    const double size = (box.max - box.min).norm();
    const double rounding = kRounding * farthest;
    if (!(rounding > kAllowed * size) || !std::isfinite(farthest)) return; // check_mesh names what is not finite
    std::ostringstream reason;
    reason << "it is " << size << " across but has coordinates up to " << farthest << ", which are rounded by "
           << rounding << "; allowed is " << kAllowed
           << " of its size: move it to the origin and place it by its position";
    refuse(file, reason.str());
}

TriangleMesh read_with_assimp(const path& file)
{
    Assimp::Importer importer;
    importer.SetIOHandler(new AssimpFiles(file.string(), plain_content(file))); // the importer's from here on
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true); // else nodes without geometry become bones
    const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
    const std::string message = importer.GetErrorString();
    if (scene == nullptr && message == "No meshes remaining") refuse(file, "it has no triangles");
    if (scene == nullptr && message.find("No suitable reader") != std::string::npos)
        refuse(file, "it is truncated, or no " + extension_of(file).substr(1) + " file");
    if (scene == nullptr || scene->mRootNode == nullptr) refuse(file, message.empty() ? "it is not valid" : message);
    SceneReader reader(file, *scene);
    // assimp turns COLLADA to Y up and metres by way of the root's transform, which a COLLADA scene has no other use
    // for: its visual_scene element cannot be moved.
    if (extension_of(file) == ".dae")
        reader.read_with(*scene->mRootNode, aiMatrix4x4());
    else
        reader.read(*scene->mRootNode, aiMatrix4x4());
    check_precision(file, reader.mesh, reader.farthest);
    return reader.mesh;
}

/// Cyclic, so that right-handed stays right-handed, except for y, where x keeps its place as in most tools.
Vec3d turned_up(const Vec3d& p, MeshFileOptions::UpAxis up)
{
    switch (up) {
    case MeshFileOptions::UpAxis::y:
        return {p.x(), -p.z(), p.y()};
    case MeshFileOptions::UpAxis::x:
        return {p.y(), p.z(), p.x()};
    case MeshFileOptions::UpAxis::z:
        break;
    }
    return p;
}

} // namespace

bool is_mesh_file_name(const path& file)
{
    return std::find(kFormats.begin(), kFormats.end(), extension_of(file)) != kFormats.end();
}

TriangleMesh load_mesh(const path& file, const MeshFileOptions& options)
{
    require(options.scale > 0.0 && std::isfinite(options.scale), "scale of a mesh file must be > 0 and finite",
            options.scale);
    check_file(file);
    TriangleMesh mesh;
    try {
        mesh = read_with_assimp(file);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        refuse(file, error.what());
    }
    if (mesh.empty()) refuse(file, "it has no triangles");
    for (Vec3d& vertex : mesh.vertices) vertex = options.scale * turned_up(vertex, options.up);
    return mesh;
}

} // namespace flotsam
