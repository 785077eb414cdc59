#include "cli/validate.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/scene/run_scene.hpp"
#include "flotsam/validation/validation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <ostream>

namespace flotsam::cli {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values)
{
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

/// The cases to run, in their own order.
std::vector<ValidationCaseInfo> chosen(const Arguments& arguments)
{
    const std::vector<ValidationCaseInfo> all = validation_cases(arguments.quick);
    std::string names;
    for (const ValidationCaseInfo& info : all) names += (names.empty() ? "" : ", ") + info.name;
    for (const std::string& name : arguments.cases)
        if (std::none_of(all.begin(), all.end(), [&](const auto& info) { return info.name == name; }))
            throw InputError("there is no validation case \"" + name + "\"; there are " + names);
    std::vector<ValidationCaseInfo> result;
    for (const ValidationCaseInfo& info : all) {
        const bool is_named =
            std::find(arguments.cases.begin(), arguments.cases.end(), info.name) != arguments.cases.end();
        if (is_named || (arguments.cases.empty() && (info.is_quick || !arguments.quick))) result.push_back(info);
    }
    return result;
}

std::string error_of(const ValidationCheck& check)
{
    if (check.spacing) return formatted("%+8.2f d", check.error() / *check.spacing);
    if (const auto error = check.relative_error()) return formatted("%+8.1f %%", 100.0 * *error);
    return formatted("%+8.2g", check.error()) + std::string(2, ' ');
}

/// Runs a case. What ends it is said with its name: there is no file to name.
ValidationResult result_of(const std::string& name, const ValidationOptions& options)
{
    try {
        return run_validation_case(name, options);
    } catch (const std::bad_alloc&) {
        throw RunFailure("validation case " + name + ": the memory ran out");
    } catch (const std::exception& error) {
        throw RunFailure("validation case " + name + ": " + error.what());
    }
}

void print(std::ostream& stream, const ValidationResult& result)
{
    for (const ValidationCheck& check : result.checks)
        stream << formatted("  %-46.46s %5.0f %11.5g %11.5g %-4s %s  %s\n", check.quantity.c_str(), check.resolution,
                            check.value, check.reference, check.unit == "-" ? "" : check.unit.c_str(),
                            error_of(check).c_str(), check.passed() ? "ok" : "OUTSIDE");
    for (const std::string& note : result.notes) stream << "  " << note << "\n";
    stream << formatted("  %.0f s\n", result.wall_seconds) << std::flush;
}

} // namespace

int validate(std::ostream& stream, const Arguments& arguments)
{
    const std::vector<ValidationCaseInfo> cases = chosen(arguments);
    std::error_code ignored;
    if (std::filesystem::exists(arguments.out, ignored) && !std::filesystem::is_directory(arguments.out, ignored))
        throw InputError("--out: " + arguments.out.string() + " is a file, and must be a directory or a new name");
    const ValidationOptions options{arguments.quick, arguments.threads};
    ValidationReport report(arguments.out, options);
    int outside = 0, made = 0;
    for (const ValidationCaseInfo& info : cases) {
        stream << info.name << ": " << info.title << formatted(" (up to %.0f s on two cores)\n", info.time_limit)
               << std::flush;
        const ValidationResult result = result_of(info.name, options);
        print(stream, result);
        made += static_cast<int>(result.checks.size());
        outside += static_cast<int>(std::count_if(result.checks.begin(), result.checks.end(),
                                                  [](const ValidationCheck& check) { return !check.passed(); }));
        report.add(result);
    }
    stream << formatted("%d of %d checks lie inside their bands. In ", made - outside, made) << arguments.out.string()
           << ": report.html, validation.csv\n";
    return outside;
}

} // namespace flotsam::cli
