// Compiled for the other precision of Bullet than flotsam was: this must not link.

#if defined(BT_USE_DOUBLE_PRECISION)
#undef BT_USE_DOUBLE_PRECISION
#else
#define BT_USE_DOUBLE_PRECISION
#endif
#include <flotsam/bullet.hpp>

int main()
{
    flotsam::FluidWorld water({});
    btDynamicsWorld* world = nullptr;
    flotsam::BulletCoupling coupling(water, *world);
    return static_cast<int>(coupling.bodies().size());
}
