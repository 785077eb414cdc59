#include "bullet/constraint_rows.hpp"

#include "bullet/convert.hpp"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace flotsam {
namespace {

double bound(btScalar value)
{
    const double wide = static_cast<double>(value);
    return std::abs(wide) >= 1e17 ? std::copysign(std::numeric_limits<double>::infinity(), wide) : wide;
}

Vec6d six(const Vec3d& linear, const Vec3d& angular)
{
    Vec6d v;
    v << linear, angular;
    return v;
}

/// The bodies of a contact, and where they touch.
struct Contact {
    int a, b;
    Vec3d arm_a, arm_b; ///< from the centres of mass
    Vec3d normal;       ///< from b to a
    double distance;
    Vec3d approach; ///< velocity of a's point seen from b's

    [[nodiscard]] ConstraintRow row(const Vec3d& direction) const
    {
        ConstraintRow row;
        row.a = a;
        row.b = b;
        row.jacobian_a = six(direction, arm_a.cross(direction));
        row.jacobian_b = six(-direction, -arm_b.cross(direction));
        return row;
    }
};

Vec3d velocity_at(const btCollisionObject& object, const Vec3d& arm)
{
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body == nullptr ? Vec3d::Zero() : from_bullet(body->getVelocityInLocalPoint(to_bullet(arm)));
}

/// As btSequentialImpulseConstraintSolver::setupContactConstraint of Bullet 3.24 sets it up.
ConstraintRow normal_row(const Contact& contact, const btManifoldPoint& point, const btContactSolverInfo& info,
                         double dt)
{
    ConstraintRow row = contact.row(contact.normal);
    row.lower = 0.0;
    row.impulse = static_cast<double>(point.m_appliedImpulse);
    double cfm = static_cast<double>(info.m_globalCfm), erp = static_cast<double>(info.m_erp2);
    const int flags = point.m_contactPointFlags;
    if (flags & (BT_CONTACT_FLAG_HAS_CONTACT_CFM | BT_CONTACT_FLAG_HAS_CONTACT_ERP)) {
        if (flags & BT_CONTACT_FLAG_HAS_CONTACT_CFM) cfm = static_cast<double>(point.m_contactCFM);
        if (flags & BT_CONTACT_FLAG_HAS_CONTACT_ERP) erp = static_cast<double>(point.m_contactERP);
    } else if (flags & BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING) {
        const double stiffness = static_cast<double>(point.m_combinedContactStiffness1);
        const double damping = static_cast<double>(point.m_combinedContactDamping1);
        const double sum = std::max(dt * stiffness + damping, static_cast<double>(SIMD_EPSILON));
        cfm = 1.0 / sum;
        erp = dt * stiffness / sum;
    }
    row.cfm = cfm / dt;
    const double gap = contact.distance + static_cast<double>(info.m_linearSlop);
    const bool is_split =
        info.m_splitImpulse != 0 && !(gap > static_cast<double>(info.m_splitImpulsePenetrationThreshold));
    const double push_out = is_split ? 0.0 : -gap * erp / dt; // split: positions are pushed apart, not velocities
    const double closing = contact.approach.dot(contact.normal);
    double bounce = 0.0;
    if (std::abs(closing) >= static_cast<double>(info.m_restitutionVelocityThreshold))
        bounce = std::max(0.0, -closing * static_cast<double>(point.m_combinedRestitution));
    row.target = bounce + (gap > 0.0 ? -gap / dt : push_out);
    return row;
}

/// Two rows along the surface and, for a patch that has a size, one about its normal.
void add_friction(const Contact& middle, double friction, double radius, int first, int count,
                  ConstrainedMotion& motion)
{
    const Vec3d along = middle.normal.unitOrthogonal(), across = middle.normal.cross(along);
    for (const Vec3d& direction : {along, across}) {
        ConstraintRow row = middle.row(direction);
        row.normal = first;
        row.normals = count;
        row.friction = friction;
        motion.add_row(row);
    }
    if (!(radius > 0.0)) return;
    ConstraintRow spin;
    spin.a = middle.a;
    spin.b = middle.b;
    spin.jacobian_a = six(Vec3d::Zero(), middle.normal);
    spin.jacobian_b = -spin.jacobian_a;
    spin.normal = first;
    spin.normals = count;
    spin.friction = friction * radius;
    motion.add_row(spin);
}

/// Of the points of one manifold: one for each normal, and friction of the whole patch about its middle.
void add_contacts(const btPersistentManifold& manifold, const btContactSolverInfo& info, double dt,
                  const MotionNumbers& numbers, ConstrainedMotion& motion)
{
    const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
    const btTransform &pose_a = a.getWorldTransform(), &pose_b = b.getWorldTransform();
    Contact middle{numbers.of(a), numbers.of(b), Vec3d::Zero(), Vec3d::Zero(), Vec3d::Zero(), 0.0, Vec3d::Zero()};
    int first = -1, count = 0;
    double weights = 0.0, friction = 0.0;
    std::array<Vec3d, MANIFOLD_CACHE_SIZE> arms;
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        const btVector3 on_a = pose_a * point.m_localPointA, on_b = pose_b * point.m_localPointB;
        Contact contact = middle;
        contact.arm_a = from_bullet(on_a - pose_a.getOrigin());
        contact.arm_b = from_bullet(on_b - pose_b.getOrigin());
        contact.normal = from_bullet(point.m_normalWorldOnB);
        contact.distance = from_bullet(on_a - on_b).dot(contact.normal);
        if (contact.distance > static_cast<double>(manifold.getContactBreakingThreshold())) continue;
        contact.approach = velocity_at(a, contact.arm_a) - velocity_at(b, contact.arm_b);
        const int row = motion.add_row(normal_row(contact, point, info, dt));
        if (first < 0) first = row;
        arms[static_cast<std::size_t>(count++)] = contact.arm_a;
        // What bears most of the load has most of the friction.
        const double weight = 1e-9 + std::max(0.0, static_cast<double>(point.m_appliedImpulse));
        weights += weight;
        middle.arm_a += weight * contact.arm_a;
        middle.arm_b += weight * contact.arm_b;
        middle.normal += weight * contact.normal;
        friction += weight * static_cast<double>(point.m_combinedFriction);
    }
    if (count == 0 || !(friction > 0.0) || !(middle.normal.norm() > 0.0)) return;
    middle.arm_a /= weights;
    middle.arm_b /= weights;
    middle.normal.normalize();
    double radius = 0.0;
    for (int k = 0; k < count; ++k)
        radius += (arms[static_cast<std::size_t>(k)] - middle.arm_a).cross(middle.normal).norm() / count;
    add_friction(middle, friction / weights, radius, first, count, motion);
}

} // namespace

void MotionNumbers::reset(const btDynamicsWorld& world)
{
    entries_.assign(static_cast<std::size_t>(world.getNumCollisionObjects()), Entry{});
}

void MotionNumbers::set(const btCollisionObject& object, int number, bool responds)
{
    const int index = object.getWorldArrayIndex();
    if (index >= 0) entries_[static_cast<std::size_t>(index)] = {number, responds};
}

int MotionNumbers::of(const btCollisionObject& object) const
{
    const int index = object.getWorldArrayIndex();
    return index < 0 ? kNone : entries_[static_cast<std::size_t>(index)].number;
}

bool MotionNumbers::responds(const btCollisionObject& object) const
{
    const int index = object.getWorldArrayIndex();
    return index >= 0 && entries_[static_cast<std::size_t>(index)].responds;
}

void ConstraintCollector::find_links(const btDynamicsWorld& world)
{
    links_.clear();
    for (int k = 0; k < world.getNumConstraints(); ++k) {
        auto* joint = const_cast<btTypedConstraint*>(world.getConstraint(k)); // getInfo2 is not const
        if (joint->isEnabled()) links_.push_back({&joint->getRigidBodyA(), &joint->getRigidBodyB(), joint, nullptr});
    }
    auto* dispatcher = const_cast<btDispatcher*>(world.getDispatcher());
    for (int k = 0; k < dispatcher->getNumManifolds(); ++k) {
        btPersistentManifold* manifold = dispatcher->getManifoldByIndexInternal(k);
        if (manifold->getNumContacts() == 0) continue;
        const btCollisionObject *a = manifold->getBody0(), *b = manifold->getBody1();
        if (dispatcher->needsResponse(a, b)) links_.push_back({a, b, nullptr, manifold});
    }
}

void ConstraintCollector::add_rows(const btDynamicsWorld& world, double dt, const MotionNumbers& numbers,
                                   ConstrainedMotion& motion)
{
    const btContactSolverInfo& info = const_cast<btDynamicsWorld&>(world).getSolverInfo();
    for (const Link& link : links_) {
        if (!numbers.responds(*link.a) && !numbers.responds(*link.b)) continue;
        if (link.joint != nullptr)
            add_joint(world, dt, numbers, *link.joint, motion);
        else
            add_contacts(*link.contacts, info, dt, numbers, motion);
    }
}

/// As btSequentialImpulseConstraintSolver::convertJoint of Bullet 3.24 does it.
void ConstraintCollector::add_joint(const btDynamicsWorld& world, double dt, const MotionNumbers& numbers,
                                    btTypedConstraint& joint, ConstrainedMotion& motion)
{
    const btContactSolverInfo& info = const_cast<btDynamicsWorld&>(world).getSolverInfo();
    joint.buildJacobian();
    btTypedConstraint::btConstraintInfo1 size{};
    joint.getInfo1(&size);
    if (size.m_numConstraintRows <= 0) return;
    joint_rows_.resize(static_cast<std::size_t>(size.m_numConstraintRows));
    for (JointRow& row : joint_rows_) {
        row = {};
        row.cfm = info.m_globalCfm;
        row.lower = -SIMD_INFINITY;
        row.upper = SIMD_INFINITY;
    }
    JointRow& first = joint_rows_.front();
    btTypedConstraint::btConstraintInfo2 rows{};
    rows.fps = static_cast<btScalar>(1.0 / dt);
    rows.erp = info.m_erp;
    rows.m_J1linearAxis = first.linear_a;
    rows.m_J1angularAxis = first.angular_a;
    rows.m_J2linearAxis = first.linear_b;
    rows.m_J2angularAxis = first.angular_b;
    rows.m_constraintError = &first.target;
    rows.cfm = &first.cfm;
    rows.m_lowerLimit = &first.lower;
    rows.m_upperLimit = &first.upper;
    rows.rowskip = static_cast<int>(sizeof(JointRow) / sizeof(btScalar));
    rows.m_numIterations = info.m_numIterations;
    rows.m_damping = info.m_damping;
    joint.getInfo2(&rows);
    const double most = bound(joint.getBreakingImpulseThreshold());
    for (const JointRow& from : joint_rows_) {
        ConstraintRow row;
        row.a = numbers.of(joint.getRigidBodyA());
        row.b = numbers.of(joint.getRigidBodyB());
        row.jacobian_a = six(from_bullet(from.linear_a), from_bullet(from.angular_a));
        row.jacobian_b = six(from_bullet(from.linear_b), from_bullet(from.angular_b));
        row.target = static_cast<double>(from.target);
        row.lower = std::max(bound(from.lower), -most);
        row.upper = std::min(bound(from.upper), most);
        row.relative_cfm = static_cast<double>(from.cfm); // Bullet scales a joint's by the row's own term
        motion.add_row(row);
    }
}

} // namespace flotsam
