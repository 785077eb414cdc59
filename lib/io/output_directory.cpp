#include "flotsam/io/output_directory.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_error.hpp"
#include "io/output_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <string>
#include <system_error>

#include <unistd.h>

namespace flotsam {

namespace fs = std::filesystem;

namespace {

void check(const std::error_code& error, const std::string& attempt)
{
    if (error) throw OutputError("cannot " + attempt + ": " + error.message());
}

/// How an output of ours is known: by a file that each has with what is in it, and that there is nothing else.
struct Mark {
    const char* file;
    std::initializer_list<const char*> keys;
    std::initializer_list<const char*> names; ///< of all that may be there
};

const Mark& mark_of(OutputKind kind)
{
    static const Mark run{"report.json",
                          {"version", "particles", "steps"},
                          {"report.json", "history.csv", "particles.pvd", "bodies.pvd", "vtk", "pictures"}};
    static const Mark hydrostatics{"hydrostatics.json",
                                   {"version", "mesh", "stable_poses"},
                                   {"hydrostatics.json", "poses.csv", "righting_arm.csv", "righting_arm.png"}};
    return kind == OutputKind::run ? run : hydrostatics;
}

/// A name alone would do for most, but other programs write a report.json too, and what is ours is removed.
bool has_mark(const fs::path& directory, const Mark& mark)
{
    std::ifstream stream(directory / mark.file);
    if (!stream) return false;
    const auto report = nlohmann::json::parse(stream, nullptr, /*allow_exceptions=*/false);
    return report.is_object() &&
           std::all_of(mark.keys.begin(), mark.keys.end(), [&](const char* key) { return report.contains(key); });
}

/// The first by name of what somebody else has put into a directory of ours; empty if there is nothing.
std::string foreign_name(const fs::path& directory, const Mark& mark)
{
    std::string first;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
        const std::string name = entry.path().filename().string();
        if (std::find(mark.names.begin(), mark.names.end(), name) != mark.names.end()) continue;
        if (first.empty() || name < first) first = name;
    }
    check(error, "read the directory " + directory.string());
    return first;
}

void require_replaceable(const fs::path& target, OutputKind kind)
{
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (status.type() == fs::file_type::not_found) {
        if (fs::is_symlink(fs::symlink_status(target, error)))
            throw InputError("the output directory " + target.string() + " is a link to nothing; remove it");
        return;
    }
    if (status.type() == fs::file_type::none) // a name that is too long, or behind a closed door
        throw InputError("cannot look at the output directory " + target.string() + ": " + error.message());
    if (!fs::is_directory(status)) {
        throw InputError("the output directory " + target.string() + " is a file; give the name of a directory");
    }
    const bool empty = fs::is_empty(target, error);
    check(error, "read the directory " + target.string());
    if (empty) return;
    const Mark& mark = mark_of(kind);
    if (!has_mark(target, mark)) {
        throw InputError("the output directory " + target.string() +
                         " holds something else than an older output of this command (which has its " + mark.file +
                         "); give a new or an empty directory");
    }
    if (const std::string name = foreign_name(target, mark); !name.empty()) {
        throw InputError("the output directory " + target.string() + " holds " + name +
                         " beside an older output, which would be lost; move it, or give a new or an empty directory");
    }
}

/// Absolute, links followed, without a slash at its end.
fs::path settled_name(const fs::path& target)
{
    if (target.empty()) throw InputError("the output directory has an empty name");
    std::error_code error;
    fs::path name = fs::weakly_canonical(fs::absolute(target), error);
    if (error) name = fs::absolute(target).lexically_normal();
    if (!name.has_filename()) name = name.parent_path();
    return name;
}

/// The topmost parent of `path` that is not there yet; empty when all are.
fs::path first_missing_parent(const fs::path& path)
{
    fs::path missing;
    std::error_code ignored;
    for (fs::path p = path.parent_path(); !fs::exists(p, ignored) && p.has_relative_path(); p = p.parent_path()) {
        missing = p;
    }
    return missing;
}

/// Renames `from` to the first of BASE, BASE-2, BASE-3, ... that is free.
fs::path free_name(const fs::path& base)
{
    fs::path name = base;
    std::error_code ignored;
    for (int k = 2; fs::exists(fs::symlink_status(name, ignored)); ++k) name = base.string() + '-' + std::to_string(k);
    return name;
}

fs::path beside(const fs::path& path, const std::string& ending)
{
    return path.string() + ending;
}

} // namespace

void write_text_atomically(const fs::path& file, std::string_view text)
{
    const fs::path partial = beside(file, ".partial");
    OutputFile stream(partial);
    stream.write(text);
    stream.close();
    std::error_code error;
    fs::rename(partial, file, error);
    if (!error) return;
    std::error_code ignored;
    fs::remove(partial, ignored);
    check(error, "write " + file.string());
}

OutputDirectory::OutputDirectory(const fs::path& target, OutputKind kind)
    : target_(settled_name(target)), kind_(kind), first_made_parent_(first_missing_parent(target_))
{
    require_replaceable(target_, kind_);
    path_ = free_name(beside(target_, ".partial-" + std::to_string(::getpid())));
    std::error_code error;
    fs::create_directories(path_, error);
    if (error) remove_traces();
    if (error && error != std::errc::no_space_on_device) // a name that cannot be: somebody's input
        throw InputError("cannot make the output directory " + target_.string() + ": " + error.message());
    check(error, "make the output directory " + target_.string());
}

OutputDirectory::~OutputDirectory()
{
    if (!settled_) remove_traces();
}

void OutputDirectory::commit()
{
    require(!settled_, "an output directory is committed or kept once");
    require_replaceable(target_, kind_);
    std::error_code error;
    std::error_code ignored;
    fs::path old;
    if (fs::exists(target_, ignored)) {
        old = free_name(beside(target_, ".old-" + std::to_string(::getpid())));
        fs::rename(target_, old, error);
        check(error, "replace the older output " + target_.string());
    }
    fs::rename(path_, target_, error);
    if (error && !old.empty()) fs::rename(old, target_, ignored);
    check(error, "give the output directory its name " + target_.string());
    settled_ = true;
    path_ = target_;
    if (!old.empty()) fs::remove_all(old, error);
    check(error, "remove all of the older output, now at " + old.string());
}

const fs::path& OutputDirectory::keep_partial()
{
    if (settled_) return path_;
    settled_ = true;
    const fs::path name = beside(target_, ".partial");
    std::error_code error;
    if (!fs::exists(fs::symlink_status(name, error))) {
        fs::rename(path_, name, error);
        if (!error) path_ = name;
    }
    return path_;
}

void OutputDirectory::remove_traces() noexcept
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (first_made_parent_.empty()) return;
    // Upwards while empty: another program may have put something there meanwhile.
    for (fs::path p = target_.parent_path(); fs::remove(p, ignored) && p != first_made_parent_;) p = p.parent_path();
}

} // namespace flotsam
