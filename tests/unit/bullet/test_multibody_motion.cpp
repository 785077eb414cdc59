#include "multibody_scene.hpp"
#include "support/catch.hpp"

using namespace flotsam;
using namespace flotsam::test;

namespace {

constexpr double kStep = 0.004;
constexpr auto kJoints = {"r", "p", "s", "l", "f", "", "rrr", "sprlf", "rfspr"};

double largest_difference(const std::vector<Twist>& a, const std::vector<Twist>& b)
{
    REQUIRE(a.size() == b.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, difference(a[k], b[k]));
    return largest;
}

std::vector<Twist> predictions(const MultibodyMotion& motion)
{
    return twists_of(motion, motion.predicted_joint_velocity());
}

/// predicted + mobility * impulses
std::vector<Twist> expectations(const MultibodyMotion& motion, const std::vector<Wrench>& impulses)
{
    std::vector<Twist> expected = predictions(motion), answer(impulses.size());
    motion.mobility().respond(impulses, answer);
    for (std::size_t k = 0; k < answer.size(); ++k) {
        expected[k].linear += answer[k].linear;
        expected[k].angular += answer[k].angular;
    }
    return expected;
}

/// Random impulses in each of Bullet's ticks, each checked in the next.
struct Ticks {
    MultibodyMotion motion;
    const MultibodyScene& scene;
    Random& random;
    std::vector<Twist> expected; ///< after the last tick

    [[nodiscard]] std::vector<Twist> now() const { return twists_of(motion, joint_velocity(motion.body())); }
    void tick(double dt)
    {
        if (!expected.empty()) {
            CHECK(largest_difference(now(), expected) < kTolerance);
            motion.withdraw();
        }
        motion.read(dt, scene.gravity, true);
        const std::vector<Wrench> impulses = random_impulses(motion.size(), random);
        expected = expectations(motion, impulses);
        motion.apply(impulses);
    }
};

} // namespace

TEST_CASE("poses and twists of links are those of Bullet", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 4u)));
    const std::string joints = GENERATE(values<const char*>(kJoints));
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, joints, GENERATE(false, true), random);
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);

    std::vector<btVector3> angular(static_cast<std::size_t>(motion.size())), linear(angular.size());
    body.compTreeLinkVelocities(angular.data(), linear.data()); // in the frames of the links
    for (int link = 0; link < motion.size(); ++link) {
        const auto k = static_cast<std::size_t>(link);
        const Pose& pose = motion.pose(link);
        const Vec3d point = random.vector();
        const btVector3 at = body.localPosToWorld(link - 1, to_bullet(point));
        CHECK((pose.to_world(point) - from_bullet(at)).norm() < kTolerance);
        const Twist expected{pose.orientation * from_bullet(linear[k]), pose.orientation * from_bullet(angular[k])};
        CHECK(difference(motion.twist(link), expected) < kTolerance);
        if (link == 0) continue;
        const Pose cached = from_bullet(body.getLink(link - 1).m_cachedWorldTransform); // brought up to date
        CHECK((cached.position - pose.position).norm() < kTolerance);
    }
}

TEST_CASE("a multibody's predicted twists are Bullet's velocities after a step", "[bullet][oracle]")
{
    Random random(GENERATE(range(1u, 6u)));
    const std::string joints = GENERATE(values<const char*>(kJoints));
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, joints, GENERATE(false, true), random);
    add_random_forces(body, random);
    body.setLinearDamping(btScalar(0.3));
    body.setAngularDamping(btScalar(0.2));
    body.setUseGyroTerm(GENERATE(false, true));
    MultibodyMotion motion(body);

    const Eigen::VectorXd before = joint_velocity(body);
    motion.read(kStep, scene.gravity, false);
    CHECK(joint_velocity(body) == before); // reading changes nothing
    scene.step(kStep);
    const std::vector<Twist> after = twists_of(motion, joint_velocity(body));
    if (body.getNumDofs() > 0 || !body.hasFixedBase())
        REQUIRE(largest_difference(after, twists_of(motion, before)) > 1e-3);
    CHECK(largest_difference(after, predictions(motion)) < kTolerance);
}

TEST_CASE("impulses on links change Bullet's velocities by what the mobility says", "[bullet][property]")
{
    Random random(GENERATE(range(1u, 6u)));
    const std::string joints = GENERATE(values<const char*>(kJoints));
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, joints, GENERATE(false, true), random);
    body.setLinearDamping(btScalar(0.5)); // of the impulses nothing is damped
    body.setAngularDamping(btScalar(0.5));
    MultibodyMotion motion(body);
    motion.read(kStep, scene.gravity, false);

    const std::vector<Wrench> impulses = random_impulses(motion.size(), random);
    const std::vector<Twist> expected = expectations(motion, impulses);
    motion.apply(impulses);
    scene.step(kStep);
    if (body.getNumDofs() > 0 || !body.hasFixedBase())
        REQUIRE(largest_difference(expected, predictions(motion)) > 1e-3);
    CHECK(largest_difference(twists_of(motion, joint_velocity(body)), expected) < kTolerance);
}

TEST_CASE("forces of one tick are taken back before the next", "[bullet]")
{
    Random random(5);
    MultibodyScene scene;
    btMultiBody& body = add_random_multibody(scene, "rsp", false, random);
    Ticks ticks{MultibodyMotion(body), scene, random, {}};
    const auto tick = [](btDynamicsWorld* world, btScalar dt) {
        static_cast<Ticks*>(world->getWorldUserInfo())->tick(static_cast<double>(dt));
    };
    scene.world.setInternalTickCallback(tick, &ticks, true);
    CHECK(scene.world.stepSimulation(btScalar(3.5 * kStep), 10, btScalar(kStep)) == 3);
    REQUIRE(ticks.expected.size() == 4);
    CHECK(largest_difference(ticks.now(), ticks.expected) < kTolerance);
    CHECK(body.getBaseForce().isZero()); // Bullet clears
}

TEST_CASE("a multibody refuses what it cannot do with a sentence", "[bullet]")
{
    Random random(1);
    MultibodyScene scene;
    MultibodyMotion motion(add_random_multibody(scene, "r", true, random));
    CHECK_THROWS_AS(motion.apply(std::vector<Wrench>(2)), std::invalid_argument);
    CHECK_THROWS_AS(motion.read(0.0, scene.gravity, false), std::invalid_argument);
    CHECK_THROWS_AS(motion.read(NAN, scene.gravity, false), std::invalid_argument);
    motion.read(kStep, scene.gravity, false);
    CHECK_THROWS_AS(motion.apply(std::vector<Wrench>(1)), std::invalid_argument);
}
