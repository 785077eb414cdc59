#pragma once

#include <filesystem>
#include <string_view>

namespace flotsam {

/// Writes `text` beside `file` and renames it into place: readers see the old file or the new one, whole.
/// Throws OutputError; the old file is then as it was.
void write_text_atomically(const std::filesystem::path& file, std::string_view text);

/// What an output is of; one of another kind is not replaced.
enum class OutputKind { run, hydrostatics };

/// A directory of results that appears whole or not at all: everything is written to a temporary directory beside the
/// target, which takes the target's name on commit.
///
/// An older output of the same kind (a directory whose report.json or hydrostatics.json is one of ours, and that holds
/// nothing beside what flotsam writes) is replaced, an empty directory too; any other directory is never touched.
/// Missing parents are made. Without commit or keep_partial the destructor removes what was written.
class OutputDirectory {
  public:
    /// Throws InputError when `target` is a file or a directory that is not ours to replace; OutputError when the
    /// system refuses.
    explicit OutputDirectory(const std::filesystem::path& target, OutputKind kind = OutputKind::run);
    ~OutputDirectory();
    OutputDirectory(const OutputDirectory&) = delete;
    OutputDirectory& operator=(const OutputDirectory&) = delete;

    /// Where to write now: TARGET.partial-PID, and the target after commit.
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Gives the directory its name. Throws InputError when a foreign directory has taken it meanwhile, OutputError
    /// when the system refuses; the older output is then as it was.
    void commit();

    /// Leaves what was written so far, as TARGET.partial when that name is free, and returns where it is.
    const std::filesystem::path& keep_partial();

  private:
    void remove_traces() noexcept;

    std::filesystem::path target_;
    OutputKind kind_;
    std::filesystem::path path_;
    std::filesystem::path first_made_parent_; ///< empty: all parents were there
    bool settled_ = false;
};

} // namespace flotsam
