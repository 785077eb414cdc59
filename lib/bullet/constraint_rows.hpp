#pragma once

#include "bullet/constrained_motion.hpp"

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

namespace flotsam {

/// Which collision objects of a Bullet world have which number in a ConstrainedMotion.
class MotionNumbers {
  public:
    static constexpr int kNone = -1;

    void reset(const btDynamicsWorld& world);
    void set(const btCollisionObject& object, int number, bool responds);
    [[nodiscard]] int of(const btCollisionObject& object) const;
    [[nodiscard]] bool responds(const btCollisionObject& object) const;

  private:
    struct Entry {
        int number = kNone;
        bool responds = false;
    };
    std::vector<Entry> entries_; ///< by the object's index in its world
};

/// What Bullet's solver will hold the bodies of a ConstrainedMotion to in a step: joints (btTypedConstraint, whatever
/// it is: its rows come from getInfo2, as btSequentialImpulseConstraintSolver gets them) and contacts.
///
/// Contacts are those of the last collision detection, with distances of now. A contact's rows are its normal,
/// J v >= -distance / dt (restitution and error reduction as in the solver). **Differs** from Bullet in friction: two
/// rows along the surface and one about the normal for all points of a manifold together, where Bullet has one or two
/// for each; they hold and slide alike, with fewer ways to share the load. Rolling friction is left out.
class ConstraintCollector {
  public:
    /// Adds to `motion` the dynamic bodies, by `add_body(btRigidBody&) -> number`, that hang together with responding
    /// ones by joints and contacts, then the rows between all of them. `dt`: length of the Bullet step [s].
    template <class AddBody>
    void collect(const btDynamicsWorld& world, double dt, MotionNumbers& numbers, ConstrainedMotion& motion,
                 AddBody&& add_body)
    {
        find_links(world);
        for (bool found = true; found;) {
            found = false;
            for (const Link& link : links_) {
                found = reach(*link.a, *link.b, numbers, add_body) || found;
                found = reach(*link.b, *link.a, numbers, add_body) || found;
            }
        }
        add_rows(world, dt, numbers, motion);
    }

  private:
    /// Two objects that a joint or contacts hold together.
    struct Link {
        const btCollisionObject *a, *b;
        btTypedConstraint* joint = nullptr;
        btPersistentManifold* contacts = nullptr;
    };
    /// One row of a joint; Bullet steps from row to row in btScalars.
    struct JointRow {
        btVector3 linear_a, angular_a, linear_b, angular_b;
        btScalar target, cfm, lower, upper;
    };
    static_assert(sizeof(JointRow) == 20 * sizeof(btScalar));

    template <class AddBody>
    static bool reach(const btCollisionObject& from, const btCollisionObject& to, MotionNumbers& numbers,
                      AddBody& add_body)
    {
        if (!numbers.responds(from) || numbers.of(to) != MotionNumbers::kNone || to.isStaticObject()) return false;
        auto* body = const_cast<btRigidBody*>(btRigidBody::upcast(&to)); // Bullet's manifolds know const bodies only
        if (body == nullptr || body->getWorldArrayIndex() < 0) return false;
        numbers.set(to, add_body(*body), !body->isStaticOrKinematicObject());
        return true;
    }
    void find_links(const btDynamicsWorld& world);
    void add_rows(const btDynamicsWorld& world, double dt, const MotionNumbers& numbers, ConstrainedMotion& motion);
    void add_joint(const btDynamicsWorld& world, double dt, const MotionNumbers& numbers, btTypedConstraint& joint,
                   ConstrainedMotion& motion);

    std::vector<Link> links_;
    std::vector<JointRow> joint_rows_;
};

} // namespace flotsam
