#include "flotsam/core/contracts.hpp"
#include "flotsam/core/parallel.hpp"
#include "flotsam/io/csv.hpp"
#include "flotsam/io/output_directory.hpp"
#include "flotsam/io/output_error.hpp"
#include "flotsam/validation/validation.hpp"
#include "flotsam/version.hpp"
#include "io/markup_text.hpp"
#include "validation/draw_chart.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace flotsam {
namespace {

std::string digits(double value, int count)
{
    std::ostringstream text;
    text << std::setprecision(count) << value;
    return text.str();
}

std::string with_sign(double value, int decimals)
{
    std::ostringstream text;
    text << std::showpos << std::fixed << std::setprecision(decimals) << value;
    return text.str();
}

std::string error_percent(const ValidationCheck& check)
{
    const auto error = check.relative_error();
    return error ? with_sign(100.0 * *error, 2) : "";
}

std::string error_in_spacings(const ValidationCheck& check)
{
    return check.spacing ? with_sign(check.error() / *check.spacing, 3) : "";
}

std::string order(const ValidationResult& result, const ValidationCheck& check)
{
    const auto value = order_of_convergence(result, check.quantity);
    return value ? with_sign(*value, 1) : "";
}

// -- CSV --------------------------------------------------------------------------------------------------------------

std::string csv_of(const std::vector<ValidationResult>& results)
{
    std::ostringstream csv;
    csv << "case,quantity,unit,resolution,value,reference,tolerance,error,error_percent,error_spacings,order,passed,"
           "simulated_seconds,wall_seconds\n";
    csv.precision(9);
    for (const ValidationResult& result : results)
        for (const ValidationCheck& c : result.checks)
            csv << result.name << ',' << csv_cell(c.quantity) << ',' << csv_cell(c.unit) << ',' << c.resolution << ','
                << c.value << ',' << c.reference << ',' << c.tolerance << ',' << c.error() << ',' << error_percent(c)
                << ',' << error_in_spacings(c) << ',' << order(result, c) << ',' << (c.passed() ? "yes" : "no") << ','
                << c.simulated_seconds << ',' << c.wall_seconds << '\n';
    return csv.str();
}

// -- HTML -------------------------------------------------------------------------------------------------------------

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>flotsam: validation</title><style>
body { font: 15px/1.45 sans-serif; max-width: 1060px; margin: 2em auto; padding: 0 1em; color: #222 }
h1 { font-size: 1.6em } h2 { font-size: 1.2em; margin-top: 2.2em; border-bottom: 1px solid #ccc }
table { border-collapse: collapse; font-size: 13px; width: 100% }
th, td { padding: 2px 8px; text-align: right; border-bottom: 1px solid #e4e4e4 }
th:first-child, td:first-child { text-align: left }
td.ok { color: #1a7a2e } td.outside { color: #b3261e; font-weight: bold }
svg, img { max-width: 100%; height: auto; margin-top: 1em }
figure { margin: 0 } figcaption { font-size: 13px; color: #555 }
</style></head><body>
)";

std::string processor()
{
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.rfind("model name", 0) == 0 && line.find(':') != std::string::npos)
            return line.substr(line.find(':') + 2);
    return "unknown processor";
}

std::string today()
{
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
    return text;
}

int count_passed(const ValidationResult& result)
{
    return static_cast<int>(
        std::count_if(result.checks.begin(), result.checks.end(), [](const auto& check) { return check.passed(); }));
}

/// **Source:** RFC 4648, section 4.
std::string base64_of(const std::vector<std::uint8_t>& bytes)
{
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t group = 0;
        for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < count ? bytes[k + j] : 0u);
        for (std::size_t j = 0; j < 4; ++j) text += j <= count ? kDigits[group >> (18 - 6 * j) & 63u] : '=';
    }
    return text;
}

void write_summary(std::ostream& html, const std::vector<ValidationResult>& results)
{
    html << "<table><tr><th>case</th><th>inside their bands</th><th>time [s]</th><th>limit [s]</th></tr>\n";
    for (const ValidationResult& r : results)
        html << "<tr><td><a href=\"#" << r.name << "\">" << escaped(r.title) << "</a> (" << escaped(r.group)
             << ")</td><td class=\"" << (r.passed() ? "ok" : "outside") << "\">" << count_passed(r) << " of "
             << r.checks.size() << "</td><td>" << std::lround(r.wall_seconds) << "</td><td>" << r.time_limit
             << "</td></tr>\n";
    html << "</table>\n";
}

void write_checks(std::ostream& html, const ValidationResult& result)
{
    html << "<table><tr><th>quantity</th><th>size / spacing</th><th>measured</th><th>reference</th><th>band</th>"
            "<th>error [%]</th><th>error [spacings]</th><th>order</th><th></th></tr>\n";
    for (const ValidationCheck& c : result.checks)
        html << "<tr><td>" << escaped(c.quantity) << (c.unit == "-" ? "" : " [" + escaped(c.unit) + "]") << "</td><td>"
             << digits(c.resolution, 3) << "</td><td>" << digits(c.value, 4) << "</td><td>" << digits(c.reference, 4)
             << "</td><td>&plusmn; " << digits(c.tolerance, 2) << "</td><td>" << error_percent(c) << "</td><td>"
             << error_in_spacings(c) << "</td><td>" << order(result, c) << "</td><td class=\""
             << (c.passed() ? "ok\">inside" : "outside\">outside") << "</td></tr>\n";
    html << "</table>\n";
}

std::string section_of(const ValidationResult& result)
{
    std::ostringstream html;
    html << "<h2 id=\"" << result.name << "\">" << escaped(result.title) << "</h2>\n";
    write_checks(html, result);
    for (const std::string& note : result.notes) html << "<p>" << escaped(note) << "</p>\n";
    for (const ValidationPicture& picture : result.pictures)
        html << "<figure><img alt=\"" << escaped(picture.caption) << "\" src=\"data:image/png;base64,"
             << base64_of(picture.png) << "\"><figcaption>" << escaped(picture.caption) << "</figcaption></figure>\n";
    for (const ValidationChart& chart : result.charts) {
        try {
            html << validation::svg_of(chart) << "\n";
        } catch (const OutputError& error) {
            html << "<p>" << escaped(chart.title) << ": not drawn. " << escaped(error.what()) << "</p>\n";
        }
    }
    return html.str();
}

std::string html_of(const std::vector<ValidationResult>& results, const std::vector<std::string>& sections,
                    const ValidationOptions& options)
{
    double seconds = 0.0;
    for (const ValidationResult& result : results) seconds += result.wall_seconds;
    const int threads = Workers(options.threads).threads();
    std::ostringstream html;
    html << kHead << "<h1>flotsam " << kVersion << ": validation" << (options.quick ? " (quick)" : "") << "</h1>\n<p>"
         << today() << ", " << escaped(processor()) << ", " << threads << (threads == 1 ? " thread, " : " threads, ")
         << std::lround(seconds)
         << " s. Order: of the errors' convergence with the resolution, where there are several "
         << "of it.</p>\n";
    write_summary(html, results);
    for (const std::string& section : sections) html << section;
    html << "</body></html>\n";
    return html.str();
}

} // namespace

ValidationReport::ValidationReport(std::filesystem::path directory, const ValidationOptions& options)
    : directory_(std::move(directory)), options_(options)
{
    std::error_code failed;
    std::filesystem::create_directories(directory_, failed);
    if (failed) throw InputError("the directory " + directory_.string() + " cannot be made: " + failed.message());
}

void ValidationReport::add(const ValidationResult& result)
{
    results_.push_back(result);
    sections_.push_back(section_of(result));
    write_text_atomically(directory_ / "validation.csv", csv_of(results_));
    write_text_atomically(directory_ / "report.html", html_of(results_, sections_, options_));
}

} // namespace flotsam
