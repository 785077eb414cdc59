#pragma once

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

/// The module table of the architecture, and the arrows of a source file that break it.
namespace architecture {

using Names = std::vector<std::string>;

inline bool contains(const Names& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

struct Module {
    std::string name;
    int floor = 0;
    Names may_include; ///< modules, besides its own
    Names libraries;   ///< besides Eigen, whose types every public header speaks
};

/// `bullet.hpp` and the like stand for the headers directly in include/flotsam.
inline const std::vector<Module>& table()
{
    static const Names below_scene = {"core", "geometry", "sph", "world", "surface", "io", "bullet"};
    static const auto with = [](Names names, std::initializer_list<std::string> more) {
        names.insert(names.end(), more);
        return names;
    };
    static const std::vector<Module> modules = {
        {"core", 1, {}, {"TBB"}},
        {"geometry", 2, {"core"}, {"assimp", "FCL", "nlohmann-json", "pugixml"}},
        {"sph", 2, {"core"}, {"Highway"}},
        {"world", 3, {"core", "geometry", "sph"}, {}},
        {"surface", 3, {"core", "geometry", "sph"}, {}},
        {"bullet", 4, {"core", "geometry", "world"}, {"Bullet"}},
        {"io", 4, {"core", "geometry", "sph", "world", "surface"}, {"nlohmann-json", "Embree", "PNG"}},
        {"scene", 5, below_scene, {"nlohmann-json", "Bullet"}},
        {"validation", 6, with(below_scene, {"scene"}), {"nlohmann-json", "Bullet"}},
        {"cli", 7, with(below_scene, {"scene", "validation"}), {"CLI11"}},
        {"version.hpp", 0, {}, {}},
        {"flotsam.hpp", 5, {"core", "geometry", "sph", "world", "surface", "io"}, {}},
        {"bullet.hpp", 6, {"core", "geometry", "sph", "world", "surface", "io", "bullet", "flotsam.hpp"}, {}},
    };
    return modules;
}

inline const Module* find_module(const std::string& name)
{
    const auto found = std::find_if(table().begin(), table().end(), [&](const Module& m) { return m.name == name; });
    return found == table().end() ? nullptr : &*found;
}

/// "" for a header of the C++ standard library, "system" for one of POSIX, "unknown" for what the table does not name.
inline std::string library_of(const std::string& header)
{
    static const std::vector<std::pair<std::regex, std::string>> patterns = {
        {std::regex("[a-z0-9_]+"), ""},
        {std::regex("Eigen/.*"), "Eigen"},
        {std::regex("(tbb|oneapi)/.*"), "TBB"},
        {std::regex("assimp/.*"), "assimp"},
        {std::regex("fcl/.*"), "FCL"},
        {std::regex("hwy/.*"), "Highway"},
        {std::regex("bt[A-Z].*|Bullet.*|LinearMath/.*"), "Bullet"},
        {std::regex("nlohmann/.*"), "nlohmann-json"},
        {std::regex("pugixml\\.hpp"), "pugixml"},
        {std::regex("embree[34]/.*"), "Embree"},
        {std::regex("png\\.h"), "PNG"},
        {std::regex("CLI/.*"), "CLI11"},
        {std::regex("(sys/)?[a-z]+\\.h"), "system"},
    };
    for (const auto& [pattern, library] : patterns)
        if (std::regex_match(header, pattern)) return library;
    return "unknown";
}

/// Where a file stands: "include/flotsam/sph/kernel.hpp" is public and of sph, "lib/sph/kernel.cpp" private.
struct Place {
    bool is_public = false;
    std::string module;
};

inline Place place_of(const std::filesystem::path& file)
{
    auto part = file.begin();
    const bool is_public = *part++ == "include";
    if (is_public) ++part; // flotsam/
    return {is_public, part->string()};
}

/// What is wrong with `#include <header>`, or "".
inline std::string judge_library(const Place& place, const Module& module, const std::string& header)
{
    const std::string library = library_of(header);
    if (library.empty() || library == "Eigen") return "";
    if (library == "unknown") return "the table names no library for it";
    const bool seam = library == "Bullet" && module.name == "bullet";
    if (place.is_public && !seam) return "a public header may include Eigen only (Bullet in flotsam/bullet)";
    if (library == "system") return "";
    return contains(module.libraries, library) ? "" : "module " + module.name + " may not use " + library;
}

/// What is wrong with `#include "header"`, or "".
inline std::string judge_own(const Place& place, const Module& module, const std::string& header)
{
    if (header.find("..") != std::string::npos) return "relative to a folder above";
    const bool of_public = header.rfind("flotsam/", 0) == 0;
    if (place.is_public && !of_public) return "a public header may not include a private one";
    const std::string rest = of_public ? header.substr(8) : header;
    const std::string target = rest.substr(0, rest.find('/'));
    const Module* known = find_module(target);
    if (known == nullptr) return of_public ? "there is no module " + target : ""; // next to the file
    if (target == module.name || target == "version.hpp" || contains(module.may_include, target)) return "";
    const bool umbrella = target == "flotsam.hpp" || target == "bullet.hpp";
    const auto reaches = [&](const std::string& name) { return contains(module.may_include, name); };
    if (umbrella &&
        std::all_of(known->may_include.begin(), known->may_include.end() - (target == "bullet.hpp"), reaches))
        return "";
    return "module " + module.name + " may not include " + target;
}

/// Every line of `text`, the contents of `file` (as "lib/..." or "include/flotsam/..."), that breaks the table.
inline std::vector<std::string> violations(const std::filesystem::path& file, const std::string& text)
{
    static const std::regex include_line("\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
    const Place place = place_of(file);
    const Module* module = find_module(place.module);
    if (module == nullptr) return {file.string() + ": there is no module " + place.module + " in the table"};

    std::vector<std::string> found;
    std::istringstream lines(text);
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
        if (!std::regex_match(line, match, include_line)) continue;
        const std::string wrong =
            match[1] == "<" ? judge_library(place, *module, match[2]) : judge_own(place, *module, match[2]);
        if (!wrong.empty()) found.push_back(file.string() + ": " + match[2].str() + ": " + wrong);
    }
    return found;
}

} // namespace architecture
