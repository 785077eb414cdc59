#include "flotsam/geometry/mass_properties.hpp"

namespace flotsam {

// Each triangle spans a tetrahedron with the bounds' centre O. With corners a, b, c from O, s = a + b + c and
// D = a . (b x c), it adds D/6 to the volume, D/24 s to the first moment and D/120 (aa' + bb' + cc' + ss') to the
// second moment: the integrals of the source, grouped.
MassProperties mass_properties(const TriangleMesh& mesh)
{
    MassProperties solid;
    if (mesh.empty()) return solid;
    const Vec3d origin = bounds(mesh).center();
    double volume = 0.0;
    Vec3d first_moment = Vec3d::Zero();
    Mat3d second_moment = Mat3d::Zero();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3d a = mesh.corner(t, 0) - origin;
        const Vec3d b = mesh.corner(t, 1) - origin;
        const Vec3d c = mesh.corner(t, 2) - origin;
        const Vec3d s = a + b + c;
        const double six_volumes = a.dot(b.cross(c));
        volume += six_volumes / 6.0;
        first_moment += six_volumes / 24.0 * s;
        second_moment +=
            six_volumes / 120.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
    }
    solid.volume = volume;
    if (volume == 0.0) {
        solid.center_of_mass = origin;
        return solid;
    }
    const Vec3d center = first_moment / volume;
    const Mat3d central = second_moment - volume * center * center.transpose();
    solid.center_of_mass = origin + center;
    solid.inertia = central.trace() * Mat3d::Identity() - central;
    return solid;
}

} // namespace flotsam
