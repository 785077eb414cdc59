#include "io/ray_group.hpp"

#include "flotsam/core/contracts.hpp"
#include "io/mesh_features.hpp"

#include <algorithm>
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

/// Which of a packet's rays are there.
struct Lanes {
    alignas(4 * kPacket) std::array<int, kPacket> valid{};

    explicit Lanes(std::size_t count) { std::fill_n(valid.begin(), count, -1); }
};

void fill(RTCRay8& packet, std::span<const Ray> rays)
{
    FLOTSAM_ASSERT(rays.size() <= kPacket, "more rays than a packet holds");
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const Ray& ray = rays[k];
        packet.org_x[k] = ray.origin.x();
        packet.org_y[k] = ray.origin.y();
        packet.org_z[k] = ray.origin.z();
        packet.dir_x[k] = ray.direction.x();
        packet.dir_y[k] = ray.direction.y();
        packet.dir_z[k] = ray.direction.z();
        packet.tnear[k] = ray.near;
        packet.tfar[k] = ray.far;
        packet.time[k] = 0.0f;
        packet.mask[k] = ~0u;
        packet.id[k] = static_cast<unsigned>(k);
        packet.flags[k] = 0;
    }
}

/// Hits of a ray, near to far; at most as many as it has room for, the nearest.
class NearestHits {
  public:
    void add(const RayHit& hit)
    {
        std::size_t place = count_;
        if (count_ < hits_.size())
            ++count_;
        else if (hits_[--place].distance <= hit.distance)
            return;
        for (; place > 0 && hits_[place - 1].distance > hit.distance; --place) hits_[place] = hits_[place - 1];
        hits_[place] = hit;
    }
    [[nodiscard]] std::span<const RayHit> all() const { return {hits_.data(), count_}; }

  private:
    std::array<RayHit, 24> hits_; ///< twice what Passed holds: where triangles meet a ray may meet both
    std::size_t count_ = 0;
};

/// Has the ray tracer note every hit and go on.
struct CollectingContext {
    RTCIntersectContext base; ///< first: the ray tracer hands back a pointer to it
    PerRay<NearestHits> hits;

    CollectingContext()
    {
        rtcInitIntersectContext(&base);
        base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        base.filter = collect;
    }
    static void collect(const RTCFilterFunctionNArguments* found)
    {
        auto& self = *reinterpret_cast<CollectingContext*>(found->context);
        for (unsigned k = 0; k < found->N; ++k) {
            if (found->valid[k] == 0) continue;
            RTCHitN* hit = found->hit;
            const unsigned n = found->N;
            self.hits[RTCRayN_id(found->ray, n, k)].add(
                {RTCRayN_tfar(found->ray, n, k), RTCHitN_u(hit, n, k), RTCHitN_v(hit, n, k),
                 Vec3(RTCHitN_Ng_x(hit, n, k), RTCHitN_Ng_y(hit, n, k), RTCHitN_Ng_z(hit, n, k)),
                 RTCHitN_geomID(hit, n, k), RTCHitN_primID(hit, n, k)});
            found->valid[k] = 0;
        }
    }
};

} // namespace

RayGroup::RayGroup(RTCDevice device) : device_(device), scene_(rtcNewScene(device))
{
    check();
    // Rays that pass exactly through an edge between two wall triangles must not see through it.
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
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

Surface RayGroup::surface_at(const Ray& ray, const RayHit& hit) const
{
    const Part& part = parts_[hit.part];
    Surface surface{part.kind, hit.distance, ray.at(hit.distance), {}, {}};
    surface.color = part.colors[part.colors.size() > 1 ? hit.primitive : 0];
    if (!part.centers.empty()) {
        surface.normal = (surface.point - part.centers[hit.primitive]).normalized();
    } else if (!part.normals.empty()) {
        const Vec3* corner = &part.normals[std::size_t{3} * hit.primitive];
        surface.normal = ((1.0f - hit.u - hit.v) * corner[0] + hit.u * corner[1] + hit.v * corner[2]).normalized();
    } else {
        surface.normal = hit.normal.normalized();
    }
    if (surface.normal.dot(ray.direction) > 0.0f) surface.normal = -surface.normal;
    return surface;
}

PerRay<std::optional<Surface>> RayGroup::closest(std::span<const Ray> rays) const
{
    const Lanes lanes(rays.size());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT; // rays from the camera; a tenth of a picture's time
    RTCRayHit8 found;
    fill(found.ray, rays);
    std::fill_n(found.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(lanes.valid.data(), scene_.get(), &context, &found);

    PerRay<std::optional<Surface>> surfaces;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const RTCHit8& hit = found.hit;
        if (hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
        surfaces[k] = surface_at(rays[k], {found.ray.tfar[k], hit.u[k], hit.v[k],
                                           Vec3(hit.Ng_x[k], hit.Ng_y[k], hit.Ng_z[k]), hit.geomID[k], hit.primID[k]});
    }
    return surfaces;
}

PerRay<Passed> RayGroup::all_along(std::span<const Ray> rays, float step) const
{
    const Lanes lanes(rays.size());
    CollectingContext context;
    RTCRayHit8 found;
    fill(found.ray, rays);
    std::fill_n(found.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(lanes.valid.data(), scene_.get(), &context.base, &found);

    PerRay<Passed> passed;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        float next = rays[k].near;
        for (const RayHit& hit : context.hits[k].all()) {
            if (hit.distance < next) continue;
            if (passed[k].count == passed[k].surfaces.size()) break;
            passed[k].surfaces[passed[k].count++] = surface_at(rays[k], hit);
            next = hit.distance + step;
        }
    }
    return passed;
}

PerRay<bool> RayGroup::blocked(std::span<const Ray> rays) const
{
    const Lanes lanes(rays.size());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay8 tested;
    fill(tested, rays);
    rtcOccluded8(lanes.valid.data(), scene_.get(), &context, &tested);

    PerRay<bool> blocked{};
    for (std::size_t k = 0; k < rays.size(); ++k) blocked[k] = tested.tfar[k] < 0.0f;
    return blocked;
}

} // namespace flotsam
