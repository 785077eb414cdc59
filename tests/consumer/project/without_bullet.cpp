// The engine-neutral target alone: no header of Bullet is to be seen here.

#include <flotsam/flotsam.hpp>
#include <flotsam/version.hpp>

#include <cmath>
#include <cstdio>

#if __has_include(<btBulletDynamicsCommon.h>)
#error "flotsam::flotsam passes Bullet on"
#endif

int main()
{
    const flotsam::TriangleMesh box = flotsam::tessellate(flotsam::BoxShape{{0.3, 0.2, 0.1}}, 0.1);
    const double volume = flotsam::mass_properties(box).volume;
    std::printf("flotsam %s, volume %.6f m^3\n", flotsam::kVersion, volume);
    return std::abs(volume - 0.006) < 1e-12 ? 0 : 1;
}
