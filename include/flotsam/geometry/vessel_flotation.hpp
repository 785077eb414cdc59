#pragma once

#include "flotsam/geometry/flotation.hpp"

#include <array>

namespace flotsam {

/// As flotation, of a vessel whose hollows are dry as long as their rims are above the water: they displace water with
/// her, and her waterplane goes across them. A cavity is a hollow without a rim. Nothing if she sinks, or founders, as
/// the water comes over a rim before she displaces her mass. What has no hollow floats as flotation says. Throws as
/// flotation does.
[[nodiscard]] std::optional<Flotation> vessel_flotation(const FloatingBody& body, const Quatd& orientation);

/// A vessel's righting arms, as far as she stays dry.
struct VesselArms {
    std::vector<RightingArm> arms; ///< of those angles that she comes to
    /// Heel [rad] at which water comes over a rim, the way to negative angles and that to positive ones: the angle of
    /// downflooding. Nothing where she is dry as far as the angles go.
    std::array<std::optional<double>, 2> flooding_heel;
};

/// As righting_arms, of a vessel that is heeled from `upright`, where she must be afloat, until she floods: found in
/// steps of five degrees, to 1e-4 degrees. Throws std::invalid_argument as righting_arms does.
[[nodiscard]] VesselArms vessel_righting_arms(const FloatingBody& body, const Quatd& upright,
                                              std::span<const double> heel_angles);

} // namespace flotsam
