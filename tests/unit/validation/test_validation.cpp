#include "flotsam/validation/validation.hpp"
#include "support/catch.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

#include <unistd.h>

using namespace flotsam;

namespace {

ValidationCheck check_of(double resolution, double value, double reference, double tolerance)
{
    ValidationCheck check;
    check.quantity = "draft";
    check.unit = "m";
    check.resolution = resolution;
    check.value = value;
    check.reference = reference;
    check.tolerance = tolerance;
    return check;
}

std::string text_of(const std::filesystem::path& file)
{
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

/// How often the text has the part.
int count(const std::string& text, const std::string& part)
{
    int found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

} // namespace

TEST_CASE("a check passes inside its band, and never without a number", "[validation]")
{
    CHECK(check_of(8, 1.05, 1.0, 0.06).passed());
    CHECK_FALSE(check_of(8, 1.07, 1.0, 0.06).passed());
    CHECK_FALSE(check_of(8, 0.93, 1.0, 0.06).passed());
    CHECK_FALSE(check_of(8, std::numeric_limits<double>::quiet_NaN(), 1.0, 0.06).passed());
    CHECK(*check_of(8, -1.1, -1.0, 0.06).relative_error() == Approx(-0.1));
    CHECK_FALSE(check_of(8, 0.1, 1e-16, 0.06).relative_error().has_value());
    ValidationResult result;
    CHECK_FALSE(result.passed()); // nothing was checked
    result.checks = {check_of(8, 1.0, 1.0, 0.1)};
    CHECK(result.passed());
    result.checks.push_back(check_of(8, 2.0, 1.0, 0.1));
    CHECK_FALSE(result.passed());
}

TEST_CASE("the order of convergence is the slope of the errors", "[validation]")
{
    ValidationResult result;
    for (const double n : {8.0, 12.0, 24.0}) result.checks.push_back(check_of(n, 1.0 + 3.0 / (n * n), 1.0, 1.0));
    CHECK(*order_of_convergence(result, "draft") == Approx(2.0));
    CHECK_FALSE(order_of_convergence(result, "heel").has_value());
    result.checks.resize(1);
    CHECK_FALSE(order_of_convergence(result, "draft").has_value());
    result.checks.push_back(check_of(12, 1.0, 1.0, 1.0)); // an error of zero has no logarithm
    CHECK_FALSE(order_of_convergence(result, "draft").has_value());
}

TEST_CASE("cases have names of their own, and quick ones quicker limits", "[validation]")
{
    std::set<std::string> names;
    double quick = 0.0, whole = 0.0;
    for (const ValidationCaseInfo& info : validation_cases(false)) {
        CHECK(names.insert(info.name).second);
        CHECK(info.time_limit > 0.0);
        whole += info.time_limit;
    }
    for (const ValidationCaseInfo& info : validation_cases(true))
        if (info.is_quick) quick += info.time_limit;
    CHECK(whole <= 3600.0);
    CHECK(quick <= 480.0);
    CHECK_THROWS_AS(run_validation_case("no such case", {}), std::invalid_argument);
}

TEST_CASE("the report is a table and a page that needs no other file", "[validation]")
{
    ValidationResult result;
    result.name = "floats";
    result.title = "Bodies <afloat>";
    result.checks = {check_of(8, 1.5, 1.0, 0.1), check_of(16, 1.05, 1.0, 0.1)};
    result.checks[0].quantity = "draft, of \"it\"";
    result.pictures = {{"A <ball>", {'M'}}, {"A cube", {'M', 'a'}}, {"Both", {0x89, 'P', 'N', 'G', 0xff, 0x00}}};
    result.charts = {{"Drafts", "size", "draft", {{"theory", ValidationCurve::Kind::reference, {0, 1}, {1, 1}}}, 0.1}};
    const auto directory =
        std::filesystem::temp_directory_path() / ("flotsam_validation_" + std::to_string(::getpid()));
    ValidationReport(directory, {}).add(result);
    const std::string csv = text_of(directory / "validation.csv"), page = text_of(directory / "report.html");
    std::filesystem::remove_all(directory);
    CHECK(contains(csv, "case,quantity,unit,resolution,value,reference,tolerance,"));
    CHECK(contains(csv, "floats,\"draft, of \"\"it\"\"\",m,8,1.5,1,0.1,0.5,+50.00,,,no,"));
    CHECK(contains(csv, "floats,draft,m,16,1.05,1,0.1,"));
    CHECK(contains(page, "Bodies &lt;afloat>"));
    CHECK(contains(page, "1 of 2"));
    CHECK(contains(page, "<svg"));
    CHECK(contains(page, "<figcaption>A &lt;ball></figcaption>"));
    for (const char* picture : {"base64,TQ==\"", "base64,TWE=\"", "base64,iVBOR/8A\""}) CHECK(contains(page, picture));
    CHECK(count(page, "src=") == 3); // and all three are in the page
    CHECK(count(page, "src=\"data:image/png;base64,") == 3);
    CHECK_FALSE(contains(page, "<?xml"));
}
