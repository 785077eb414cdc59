#pragma once

#include "flotsam/core/parallel.hpp"
#include "flotsam/core/types.hpp"
#include "flotsam/sph/neighbourhood.hpp"
#include "sph/contacts.hpp"

#include <span>
#include <vector>

namespace flotsam {

/// Answers impulses on the owners (walls and bodies) with the twist changes they cause; walls answer zero.
using OwnerResponse = FunctionRef<void(std::span<const Wrench> impulses, std::span<Twist> twists)>;

/// L^T of a mobility Y = L L^T, which may be singular.
[[nodiscard]] Eigen::Matrix<double, 6, 6> transposed_root(const Eigen::Matrix<double, 6, 6>& mobility);

/// The pressure system of one step. With x_i = dt p_i / rho_i^2 (per particle, >= 0) as unknown,
///
///     dv_i = -sum_j m (x_i + x_j) grad W_ij - x_i sum_b rho0 V_b grad W_ib        (= -M^-1 J^T lambda)
///     twist_k = Y_k sum_i m x_i row_ik                                           (the bodies' answer)
///     (A x)_i = -(J dv)_i,   (J v)_i = sum_j m (v_i - v_j) . grad W_ij + v_i . sum_b rho0 V_b grad W_ib - row_ik .
///     twist_k
///
/// A is symmetric and positive semi-definite, and never formed: a product is two gather passes over the pairs with
/// one reduction per body between them. Solve 0 <= x _|_ A x - b >= 0.
/// **Source:** Ihmsen et al. 2014 for the fluid's part; Gissler et al. 2019 for the coupling idea.
/// **Differs:** the bodies' response is part of A, not a step between solves.
class PressureSystem {
  public:
    /// Rows of an owner whose sums one thread takes.
    struct Slice {
        std::uint32_t owner, first, last;
    };
    /// What a system keeps, lent to it for its capacity; of one system at a time.
    struct Scratch {
        std::vector<Vec4> change; ///< dv of the last product [m/s]; as many as particles
        std::vector<Slice> slices;
        std::vector<Eigen::Matrix<double, 6, 1>> sums; ///< of the slices
    };
    /// Writes for each particle i of [begin, end) its unknown into unknowns[i].w.
    using Give = FunctionRef<void(std::size_t begin, std::size_t end, std::span<Vec4> unknowns)>;
    /// Gives the values of an array.
    struct GiveValues {
        std::span<const Scalar> x;
        void operator()(std::size_t begin, std::size_t end, std::span<Vec4> unknowns) const
        {
            for (std::size_t i = begin; i < end; ++i) unknowns[i][3] = x[i];
        }
    };

    /// Arrays that others need before and after: at 16 bytes a particle, sharing them is worth it.
    struct Lent {
        std::vector<Vec4>* unknowns;     ///< positions [m], and x of the last velocity_change as fourth components
        std::vector<Vec4>* own_gradient; ///< sum_j m grad W_ij + sum_b rho0 V_b grad W_ib, and sum_j |m grad W_ij|^2
    };

    /// `position`: of the particles, as the pairs were found [m].
    PressureSystem(const SelfPairs& pairs, std::span<const Vec4> position, const Contacts& contacts,
                   double particle_mass, const Workers& workers, Scratch& scratch, Lent lent);

    [[nodiscard]] std::size_t size() const { return pairs_->rows(); }
    [[nodiscard]] const Workers& workers() const { return *workers_; }
    [[nodiscard]] const Contacts& contacts() const { return *contacts_; }
    [[nodiscard]] Scalar particle_mass() const { return mass_; }

    /// x of each particle in the last velocity_change.
    [[nodiscard]] Scalar unknown(std::size_t i) const { return (*lent_.unknowns)[i][3]; }

    /// Room for a dv, of the scratch.
    [[nodiscard]] std::span<Vec4> change() const { return scratch_->change; }

    /// dv of each particle for multipliers x.
    void velocity_change(Give give, std::span<Vec4> dv) const;
    void velocity_change(std::span<const Scalar> x, std::span<Vec4> dv) const;

    /// (J v)_i for particle velocities and owner twists: the rate of change of the densities [kg/m^3/s].
    void density_rate(std::span<const Vec4> velocity, std::span<const Twist> twists, std::span<Scalar> rate) const;
    /// Of the particles [begin, end) alone, and what their velocities make of it; rate[0] is of `begin`.
    void density_rate(std::span<const Vec4> velocity, std::size_t begin, std::size_t end, std::span<Scalar> rate) const;

    /// Impulses on the owners for multipliers x, or for those of the last velocity_change [N s], [N m s].
    void impulses(std::span<const Scalar> x, std::span<Wrench> out) const;
    void impulses(std::span<Wrench> out) const;

    /// Diagonal of A without the owners' response.
    void fluid_diagonal(std::span<Scalar> diagonal) const;

    /// Adds to `diagonal`, for each particle at an owner that responds, a bound of the row sum of the owner's part of
    /// A: with u_i = L^T row_i, Y = L L^T: sum_j |u_i . u_j| <= sum_c |u_ic| sum_j |u_jc|. A relaxed Jacobi sweep with
    /// this diagonal converges however light the body is, and A scaled by it has no eigenvalue that grows with 1 /
    /// mass. A particle whose diagonal is 0 carries no pressure, and keeps it.
    void add_response_diagonal(std::span<const Eigen::Matrix<double, 6, 6>> mobility, std::span<Scalar> diagonal) const;

  private:
    template <class Unknown>
    void sum_impulses(Unknown&& x, std::span<Wrench> out) const;

    const SelfPairs* pairs_;
    const Contacts* contacts_;
    Scalar mass_;
    const Workers* workers_;
    Scratch* scratch_;
    Lent lent_;
};

class ResponsePreconditioner;

/// A PressureSystem together with the response of its owners and the scratch a product needs.
class PressureOperator {
  public:
    /// `response` may be null: owners stand still (weak coupling, and the position shift).
    void bind(const PressureSystem& system, const OwnerResponse* response, std::size_t owners);

    /// What a Krylov method may precondition with, until the next bind; null: the diagonal alone.
    void set_preconditioner(ResponsePreconditioner* preconditioner) { preconditioner_ = preconditioner; }
    [[nodiscard]] ResponsePreconditioner* preconditioner() const { return preconditioner_; }

    /// Gets (A x)_i of the particles i of a chunk, product[0] of `begin`; system().unknown(i) still has x_i.
    using Take =
        FunctionRef<void(std::size_t chunk, std::size_t begin, std::size_t end, std::span<const Scalar> product)>;

    /// out = A x.
    void apply(std::span<const Scalar> x, std::span<Scalar> out);
    /// The same without arrays of x and of A x, which a solver may need for nothing else: reading and writing them
    /// costs a tenth of a product. Both are called in parallel.
    void apply(PressureSystem::Give give, Take take);

    [[nodiscard]] const PressureSystem& system() const { return *system_; }

  private:
    const PressureSystem* system_ = nullptr;
    const OwnerResponse* response_ = nullptr;
    ResponsePreconditioner* preconditioner_ = nullptr;
    std::vector<Scalar> product_; ///< where owners respond
    std::vector<Wrench> impulses_;
    std::vector<Twist> twists_;
};

} // namespace flotsam
