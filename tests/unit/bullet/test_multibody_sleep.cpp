#include "multibody_scene.hpp"
#include "support/catch.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kStep = 0.004;

/// An arm that lies still: a floating base that is held up by nothing, put to sleep.
btMultiBody& add_sleeping(MultibodyScene& scene, Random& random)
{
    btMultiBody& body = add_random_multibody(scene, "rsp", false, random);
    body.clearVelocities();
    add_random_forces(body, random); // Bullet never clears these
    body.goToSleep();
    body.getBaseCollider()->setActivationState(ISLAND_SLEEPING);
    for (int k = 0; k < body.getNumLinks(); ++k) body.getLinkCollider(k)->setActivationState(ISLAND_SLEEPING);
    return body;
}

} // namespace

TEST_CASE("a sleeping multibody rests until an impulse wakes it, which is all that moves it then", "[bullet]")
{
    Random random(4);
    MultibodyScene scene;
    btMultiBody& body = add_sleeping(scene, random);
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);
    REQUIRE(motion.is_asleep());
    CHECK(motion.predicted_joint_velocity().isZero(0.0));
    motion.apply(std::vector<Wrench>(static_cast<std::size_t>(motion.size())));
    scene.step(kStep);
    CHECK(is_asleep(body)); // without an impulse it sleeps on
    REQUIRE_FALSE(body.getBaseForce().isZero());
    CHECK(joint_velocity(body).isZero(0.0));

    motion.read(kStep, scene.gravity, false);
    const std::vector<Wrench> impulses = random_impulses(motion.size(), random);
    std::vector<Twist> answer(impulses.size());
    motion.mobility().respond(impulses, answer);
    motion.apply(impulses);
    CHECK_FALSE(is_asleep(body));
    scene.step(kStep);
    const std::vector<Twist> after = twists_of(motion, joint_velocity(body));
    for (std::size_t k = 0; k < after.size(); ++k) CHECK(difference(after[k], answer[k]) < kTolerance);

    motion.read(kStep, scene.gravity, false); // awake, it falls
    const Twist predicted = motion.predicted(0);
    scene.step(kStep);
    CHECK(difference(twists_of(motion, joint_velocity(body))[0], predicted) < kTolerance);
}

TEST_CASE("a multibody that is woken within stepSimulation has its gravity in the rest of it", "[bullet]")
{
    Random random(4);
    MultibodyScene scene;
    btMultiBody& body = add_sleeping(scene, random);
    struct Ticks {
        MultibodyMotion motion;
        const MultibodyScene& scene;
        std::vector<Wrench> impulses;
        std::vector<std::vector<Twist>> after;
        std::vector<Twist> answer;
    } ticks{MultibodyMotion(body), scene, random_impulses(4, random), {}, std::vector<Twist>(4)};
    const auto tick = [](btDynamicsWorld* world, btScalar dt) {
        auto& t = *static_cast<Ticks*>(world->getWorldUserInfo());
        if (!t.after.empty()) t.motion.withdraw();
        t.motion.read(static_cast<double>(dt), t.scene.gravity, true);
        if (t.after.empty()) t.motion.mobility().respond(t.impulses, t.answer);
        t.motion.apply(t.after.empty() ? t.impulses : std::vector<Wrench>(4));
        t.after.push_back(twists_of(t.motion, t.motion.predicted_joint_velocity()));
    };
    scene.world.setInternalTickCallback(tick, &ticks, true);
    scene.world.stepSimulation(btScalar(2.5 * kStep), 10, btScalar(kStep));
    REQUIRE(ticks.after.size() == 2);
    const std::vector<Twist> end = twists_of(ticks.motion, joint_velocity(body));
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(difference(ticks.after[0][k], {}) == 0.0); // as it slept
        CHECK(difference(ticks.after[1][k], end[k]) < kTolerance);
    }
    // All of it falls by one step's gravity in the second step; impulses that it got move its centre of mass besides.
    double mass = 0.0;
    Vec3d momentum = Vec3d::Zero(), given = Vec3d::Zero();
    for (int link = 0; link < 4; ++link) {
        const LinkInertia inertia = inertia_of(body, link, ticks.motion.pose(link));
        mass += inertia.mass;
        momentum += inertia.mass * end[static_cast<std::size_t>(link)].linear;
        given += ticks.impulses[static_cast<std::size_t>(link)].linear;
    }
    CHECK((momentum - given - mass * kStep * scene.gravity).norm() <
          2e-3 * mass * kStep * scene.gravity.norm()); // damping
}

TEST_CASE("joint feedback and what Bullet keeps of velocities come through a read unchanged", "[bullet]")
{
    Random random(6);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "rs", false, random);
    btMultiBodyJointFeedback feedback;
    feedback.m_reactionForces.setValue(1, 2, 3, 4, 5, 6);
    body.getLink(1).m_jointFeedback = &feedback;
    body.useGlobalVelocities(true);
    body.getLink(1).m_absFrameTotVelocity.setValue(1, 2, 3, 4, 5, 6);
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);
    CHECK(body.getLink(1).m_jointFeedback == &feedback);
    CHECK(feedback.m_reactionForces.getLinear() == btVector3(4, 5, 6));
    CHECK(body.getLink(1).m_absFrameTotVelocity.getAngular() == btVector3(1, 2, 3));
    CHECK(body.getBaseForce().isZero());
}
