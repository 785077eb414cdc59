#include "validation/case.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>

namespace flotsam {
namespace {

std::vector<validation::Case> all_cases()
{
    std::vector<validation::Case> cases;
    for (const auto group : {validation::static_cases(), validation::coupled_cases(), validation::fluid_cases(),
                             validation::conservation_cases()})
        cases.insert(cases.end(), group.begin(), group.end());
    return cases;
}

} // namespace

bool ValidationResult::passed() const
{
    return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const auto& c) { return c.passed(); });
}

std::vector<ValidationCaseInfo> validation_cases(bool quick)
{
    std::vector<ValidationCaseInfo> infos;
    for (const validation::Case& c : all_cases()) {
        const bool is_quick = c.quick_limit > 0.0;
        infos.push_back({c.name, c.group, c.title, quick && is_quick ? c.quick_limit : c.full_limit, is_quick});
    }
    return infos;
}

ValidationResult run_validation_case(const std::string& name, const ValidationOptions& options)
{
    const std::vector<validation::Case> cases = all_cases();
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const auto& c) { return name == c.name; });
    if (found == cases.end()) throw std::invalid_argument("there is no validation case " + name);
    ValidationResult result;
    result.name = found->name;
    result.group = found->group;
    result.title = found->title;
    result.time_limit = options.quick && found->quick_limit > 0.0 ? found->quick_limit : found->full_limit;
    const validation::Stopwatch watch;
    found->run(options, result);
    result.wall_seconds = watch.seconds();
    return result;
}

std::optional<double> order_of_convergence(const ValidationResult& result, const std::string& quantity)
{
    std::vector<double> sizes, errors;
    for (const ValidationCheck& check : result.checks) {
        const double error = std::abs(check.error());
        if (check.quantity != quantity || !(error > 0.0)) continue;
        sizes.push_back(std::log(check.resolution));
        errors.push_back(std::log(error));
    }
    const bool differ = !sizes.empty() && std::any_of(sizes.begin(), sizes.end(),
                                                      [&](double s) { return std::abs(s - sizes.front()) > 1e-9; });
    if (!differ) return std::nullopt;
    return -validation::slope(sizes, errors);
}

} // namespace flotsam
