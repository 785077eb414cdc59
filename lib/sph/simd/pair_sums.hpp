#pragma once

#include "flotsam/core/types.hpp"
#include "flotsam/sph/neighbourhood.hpp"

#include <array>
#include <span>

/// The loops over pairs, each written once and compiled for every instruction set of the processor family (Highway);
/// the best one that the processor has is taken at run time. Each works on the rows [begin, end), on one thread; sums
/// over the neighbours of a particle are taken in a fixed order that depends on the instruction set alone.
///
/// A neighbour's values are loaded as float4 and transposed in registers (sum_gradients and sum_divergences do without,
/// which takes 4 % off a product of cubic pairs and 8 of quintic ones); SelfPairs has four bytes a pair, the slope
/// among them. With eight, a product of sum_gradients and sum_divergences took 12 % more of quintic pairs that do not
/// fit into the caches. Nanoseconds a pair of the two with 76 neighbours, AVX2, one core, as it was then: 0.5 and 0.7;
/// with stored gradients (20 bytes a pair) 0.9 and 1.0, with slopes computed anew 1.1 and 1.2, and those with gathers
/// 4.
namespace flotsam::simd {

/// out_i = sum_j w_j grad W_ij, out.w = 0; `at`: x, y, z and w.
void sum_gradients(const SelfPairs& pairs, std::span<const Vec4> at, std::size_t begin, std::size_t end,
                   std::span<Vec4> out);

/// out_(i - begin) = sum_j v_j . grad W_ij; the fourth components of `velocity` are 0.
void sum_divergences(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                     std::size_t begin, std::size_t end, std::span<Scalar> out);

/// out_i = (sum_j grad W_ij, sum_j |grad W_ij|^2)
void sum_gradient_squares(const SelfPairs& pairs, std::span<const Vec4> position, std::size_t begin, std::size_t end,
                          std::span<Vec4> out);

/// sum_j (v_j - v_i) grad W_ij^T and sum_j (x_j - x_i) grad W_ij^T: each row of three components of the gradient.
struct LinearFit {
    std::array<Scalar, 9> velocity; ///< row by row
    std::array<Scalar, 6> shape;    ///< symmetric: xx, yy, zz, xy, xz, yz
};
void fit_linear(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                std::size_t begin, std::size_t end, LinearFit* fits);

/// What a pair's viscous pull is made of; forces/viscosity.hpp has the formula.
struct ViscousPull {
    Scalar viscosity = 0;    ///< nu [m^2/s]
    Scalar width = 0;        ///< dissipation times spacing [m]; 0: no dissipation
    Scalar most = 0;         ///< largest nu_ij [m^2/s]
    Scalar softening_sq = 0; ///< [m^2]
};
/// out_i = sum_j pull_ij / (|x_ij|^2 + softening^2) grad W_ij. Half the strain rate of a particle stands in the fourth
/// components: position.w xx, velocity.w yy, and strain zz, xy, xz, yz.
void sum_viscous_pulls(const SelfPairs& pairs, std::span<const Vec4> position, std::span<const Vec4> velocity,
                       std::span<const Vec4> strain, const ViscousPull& pull, std::size_t begin, std::size_t end,
                       std::span<Vec4> out);

/// out_i = sum_j (w_i + w_j) grad W_ij x_ij^T, symmetric: xx, yy, zz, xy, xz, yz; `at`: x, y, z and w.
void sum_virials(const SelfPairs& pairs, std::span<const Vec4> at, std::size_t begin, std::size_t end,
                 std::array<Scalar, 6>* out);

/// Symmetric tensors T without trace: xx stands in the fourth component of `at`, and rest holds yy, xy, xz, yz.
/// out = sum_j w_ij T_j / sum_j w_ij, w_ij = -grad W_ij . x_ij, in the same form; 0 without neighbours.
void smooth_deviators(const SelfPairs& pairs, std::span<const Vec4> at, std::span<const Vec4> rest, std::size_t begin,
                      std::size_t end, std::span<Vec4> out_at, std::span<Vec4> out_rest);

/// out_i = sum_j e^T (T_i + T_j) e grad W_ij, e = x_ij / |x_ij|, T as above; out.w = 0.
void sum_deviator_pushes(const SelfPairs& pairs, std::span<const Vec4> at, std::span<const Vec4> rest,
                         std::size_t begin, std::size_t end, std::span<Vec4> out);

} // namespace flotsam::simd
