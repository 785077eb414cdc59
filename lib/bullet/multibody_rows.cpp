#include "bullet/multibody_rows.hpp"

#include "bullet/convert.hpp"
#include "bullet/multibody_constraint_access.hpp"
#include "flotsam/core/contracts.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace flotsam {

namespace {

/// Bullet's constraint rows find bodies by a number that they carry: gives it for a moment.
template <class Body>
class Numbered {
  public:
    Numbered(Body* body, int number) : body_(body)
    {
        if (body_ == nullptr) return;
        before_ = body_->getCompanionId();
        body_->setCompanionId(number);
    }
    ~Numbered()
    {
        if (body_ != nullptr) body_->setCompanionId(before_);
    }
    Numbered(const Numbered&) = delete;
    Numbered& operator=(const Numbered&) = delete;

  private:
    Body* body_;
    int before_ = -1;
};

/// The parent of a prismatic joint turns the axis, which Bullet's row leaves out where it does not need it.
void complete_prismatic(const btMultiBody& body, int link, MultibodyRow& row)
{
    const btMultibodyLink& joint = body.getLink(link);
    if (joint.m_jointType != btMultibodyLink::ePrismatic) return;
    const Vec3d arm = from_bullet(body.localDirToWorld(link, joint.m_cachedRVector));
    row.jacobian_b.tail<3>() = -arm.cross(row.jacobian_a.head<3>());
}

bool is_of_joint(const btMultiBodyConstraint& constraint)
{
    return constraint.getConstraintType() == MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR ||
           constraint.getConstraintType() == MULTIBODY_CONSTRAINT_LIMIT;
}

bool has_rows(btMultiBodyConstraint& constraint)
{
    if (!is_of_joint(constraint)) return constraint.getConstraintType() != MULTIBODY_CONSTRAINT_GEAR;
    const auto type = constraint.getMultiBodyA()->getLink(constraint.getLinkA()).m_jointType;
    return type == btMultibodyLink::eRevolute || type == btMultibodyLink::ePrismatic; // as Bullet has them
}

void init(btSolverBody& solver_body, btRigidBody* body)
{
    solver_body.m_originalBody = body;
    solver_body.m_worldTransform = body != nullptr ? body->getWorldTransform() : btTransform::getIdentity();
}

Vec6d stacked(const btVector3& linear, const btVector3& angular)
{
    Vec6d row;
    row << from_bullet(linear), from_bullet(angular);
    return row;
}

/// Sets target, cfm and limits from Bullet's "impulse = error * gain / own".
void set_target(double velocity, double error, double gain, double own, MultibodyRow& row)
{
    row.target = velocity + error;
    if (gain == 0.0) {
        row.lower = row.upper = std::clamp(error / own, row.lower, row.upper);
    } else if (gain > 0.0 && gain < 1.0) {
        row.target = velocity + error / gain;
        row.cfm = own * (1.0 / gain - 1.0);
    }
}

} // namespace

bool MultibodyRows::append(btMultiBodyConstraint& constraint, double dt, const btContactSolverInfo& info,
                           std::vector<MultibodyRow>& rows)
{
    require(dt > 0.0 && std::isfinite(dt), "a step must be > 0 s and finite", dt);
    if (!has_rows(constraint)) return false;
    const RigidEnds rigid = rigid_ends(constraint);
    solver_bodies_.resizeNoInitialize(3);
    init(solver_bodies_[0], nullptr); // the world
    init(solver_bodies_[1], rigid.a);
    init(solver_bodies_[2], rigid.b);
    const Numbered<btRigidBody> number_a(rigid.a, 1), number_b(rigid.b, 2);
    const Numbered<btMultiBody> none_a(constraint.getMultiBodyA(), -1), none_b(constraint.getMultiBodyB(), -1);
    bullet_rows_.resize(0);
    data_.m_jacobians.resize(0);
    data_.m_deltaVelocitiesUnitImpulse.resize(0);
    data_.m_deltaVelocities.resize(0);
    data_.m_solverBodyPool = &solver_bodies_;
    data_.m_fixedBodyId = 0;

    btContactSolverInfo settings = info;
    settings.m_timeStep = static_cast<btScalar>(dt); // the world's is of its last step
    constraint.createConstraintRows(bullet_rows_, data_, settings);
    for (int k = 0; k < bullet_rows_.size(); ++k)
        if (bullet_rows_[k].m_jacDiagABInv > 0) rows.push_back(converted(constraint, bullet_rows_[k]));
    return true;
}

MultibodyRow MultibodyRows::converted(btMultiBodyConstraint& constraint, const btMultiBodySolverConstraint& row) const
{
    MultibodyRow result;
    result.a = end(row.m_multiBodyA, row.m_linkA, row.m_solverBodyIdA);
    result.b = end(row.m_multiBodyB, row.m_linkB, row.m_solverBodyIdB);
    result.jacobian_a = stacked(row.m_contactNormal1, row.m_relpos1CrossNormal);
    result.jacobian_b = stacked(row.m_contactNormal2, row.m_relpos2CrossNormal);
    if (is_of_joint(constraint)) complete_prismatic(*row.m_multiBodyA, row.m_linkA, result);
    result.lower = static_cast<double>(row.m_lowerLimit);
    result.upper = static_cast<double>(row.m_upperLimit);
    result.number = row.m_orgDofIndex;

    const double now = velocity(row);
    const double error = static_cast<double>(row.m_rhs) / static_cast<double>(row.m_jacDiagABInv);
    const double gain = velocity_gain(constraint, row.m_orgDofIndex, now + error);
    set_target(now, error, gain, own_mobility(row), result);
    return result;
}

RowEnd MultibodyRows::end(btMultiBody* multibody, int link, int solver_body) const
{
    if (multibody != nullptr) return {multibody, link + 1, nullptr};
    return {nullptr, 0, solver_bodies_[solver_body].m_originalBody};
}

double MultibodyRows::velocity(const btMultiBodySolverConstraint& row) const
{
    const auto of_multibody = [&](const btMultiBody& body, int start) {
        double sum = 0.0;
        for (int k = 0; k < 6 + body.getNumDofs(); ++k)
            sum += static_cast<double>(data_.m_jacobians[start + k] * body.getVelocityVector()[k]);
        return sum;
    };
    const auto of_rigid = [&](int number, const btVector3& linear, const btVector3& angular) {
        const btRigidBody* body = solver_bodies_[number].m_originalBody;
        if (body == nullptr) return 0.0;
        return static_cast<double>(body->getLinearVelocity().dot(linear) + body->getAngularVelocity().dot(angular));
    };
    return (row.m_multiBodyA != nullptr
                ? of_multibody(*row.m_multiBodyA, row.m_jacAindex)
                : of_rigid(row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal)) +
           (row.m_multiBodyB != nullptr
                ? of_multibody(*row.m_multiBodyB, row.m_jacBindex)
                : of_rigid(row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal));
}

double MultibodyRows::own_mobility(const btMultiBodySolverConstraint& row) const
{
    if (row.m_multiBodyA == nullptr || row.m_multiBodyA != row.m_multiBodyB)
        return 1.0 / static_cast<double>(row.m_jacDiagABInv);
    double sum = 0.0; // Bullet's own leaves out what the two sides do to each other
    for (int k = 0; k < 6 + row.m_multiBodyA->getNumDofs(); ++k)
        sum += static_cast<double>((data_.m_jacobians[row.m_jacAindex + k] + data_.m_jacobians[row.m_jacBindex + k]) *
                                   (data_.m_deltaVelocitiesUnitImpulse[row.m_jacAindex + k] +
                                    data_.m_deltaVelocitiesUnitImpulse[row.m_jacBindex + k]));
    return sum;
}

double row_force(btMultiBodyConstraint& constraint, int row, double dt)
{
    require(row >= 0 && row < constraint.getNumRows(), "a row must be one of the constraint's", row);
    require(dt > 0.0, "a step must be > 0 s", dt);
    return static_cast<double>(constraint.getAppliedImpulse(row)) / dt;
}

} // namespace flotsam
