#include "io/ray_group.hpp"

#include "io/mesh_features.hpp"

#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace flotsam {

namespace {

constexpr double kCreaseDeg = 35.0;

template <class T>
T* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count)
{
    void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
    if (buffer == nullptr && count > 0) throw std::bad_alloc();
    return static_cast<T*>(buffer);
}

RTCRay rtc_ray(const Ray& ray)
{
    RTCRay result{};
    result.org_x = ray.origin.x();
    result.org_y = ray.origin.y();
    result.org_z = ray.origin.z();
    result.dir_x = ray.direction.x();
    result.dir_y = ray.direction.y();
    result.dir_z = ray.direction.z();
    result.tnear = ray.near;
    result.tfar = ray.far;
    result.mask = ~0u;
    return result;
}

} // namespace

RayGroup::RayGroup(RTCDevice device) : device_(device), scene_(rtcNewScene(device))
{
    check();
    // Rays that pass exactly through an edge between two wall triangles must not see through it.
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
}

void RayGroup::check() const
{
    const RTCError error = rtcGetDeviceError(device_);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error != RTC_ERROR_NONE) throw std::runtime_error("the ray tracer failed, code " + std::to_string(error));
}

void RayGroup::attach(RTCGeometry geometry, Part part)
{
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, static_cast<unsigned>(parts_.size()));
    rtcReleaseGeometry(geometry);
    parts_.push_back(std::move(part));
    check();
}

void RayGroup::add_spheres(std::span<const Vec4> centers, float radius, std::vector<Vec3> colors)
{
    if (centers.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    check();
    auto* spheres =
        new_buffer<std::array<float, 4>>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, centers.size());
    Part part{SurfaceKind::water, std::move(colors), {}, {}};
    part.centers.reserve(centers.size());
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const Vec3 center = centers[i].head<3>();
        spheres[i] = {center.x(), center.y(), center.z(), radius};
        part.centers.push_back(center);
    }
    attach(geometry, std::move(part));
}

void RayGroup::add_mesh(const TriangleMesh& mesh, const Vec3& color, SurfaceKind kind)
{
    if (mesh.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    check();
    auto* vertices =
        new_buffer<std::array<float, 3>>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec3 point = mesh.vertices[v].cast<Scalar>();
        vertices[v] = {point.x(), point.y(), point.z()};
    }
    auto* triangles =
        new_buffer<std::array<unsigned, 3>>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        triangles[t] = {static_cast<unsigned>(a), static_cast<unsigned>(b), static_cast<unsigned>(c)};
    }
    attach(geometry, {kind, {color}, {}, corner_normals(mesh, kCreaseDeg)});
}

void RayGroup::add_edges(const TriangleMesh& mesh, float radius, const Vec3& color)
{
    const auto edges = feature_edges(mesh, kCreaseDeg);
    if (edges.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    check();
    auto* ends =
        new_buffer<std::array<float, 4>>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 2 * edges.size());
    auto* starts = new_buffer<unsigned>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
        for (std::size_t k = 0; k < 2; ++k) {
            const Vec3 point = mesh.vertices[static_cast<std::size_t>(edges[e][k])].cast<Scalar>();
            ends[2 * e + k] = {point.x(), point.y(), point.z(), radius};
        }
        starts[e] = static_cast<unsigned>(2 * e);
    }
    attach(geometry, {SurfaceKind::edge, {color}, {}, {}});
}

void RayGroup::commit(const Workers& workers)
{
    // Embree builds with TBB in the arena that it is called in: called from one of the workers it keeps to their team.
    // A device with "threads=1" is no alternative, it would hold all TBB loops of the process to one thread.
    workers.for_chunks(2 * Workers::kChunk, [&](std::size_t chunk, std::size_t, std::size_t) {
        if (chunk == 0) rtcCommitScene(scene_.get());
    });
    check();
}

std::optional<Surface> RayGroup::closest(const Ray& ray) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit found{};
    found.ray = rtc_ray(ray);
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &found);
    if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    const Part& part = parts_[found.hit.geomID];
    const std::size_t primitive = found.hit.primID;
    Surface surface{part.kind, found.ray.tfar, ray.at(found.ray.tfar), {}, {}};
    surface.color = part.colors[part.colors.size() > 1 ? primitive : 0];
    if (!part.centers.empty()) {
        surface.normal = (surface.point - part.centers[primitive]).normalized();
    } else if (!part.normals.empty()) {
        const Vec3* corner = &part.normals[3 * primitive];
        const float u = found.hit.u;
        const float v = found.hit.v;
        surface.normal = ((1.0f - u - v) * corner[0] + u * corner[1] + v * corner[2]).normalized();
    } else {
        surface.normal = Vec3(found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z).normalized();
    }
    if (surface.normal.dot(ray.direction) > 0.0f) surface.normal = -surface.normal;
    return surface;
}

bool RayGroup::blocked(const Ray& ray) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay tested = rtc_ray(ray);
    rtcOccluded1(scene_.get(), &context, &tested);
    return tested.tfar < 0.0f;
}

} // namespace flotsam
