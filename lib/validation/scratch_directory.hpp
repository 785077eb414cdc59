#pragma once

#include "flotsam/io/output_error.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

namespace flotsam::validation {

/// A directory among the temporary ones that is removed with all that is in it.
class ScratchDirectory {
  public:
    /// Throws OutputError.
    ScratchDirectory()
    {
        std::string name = (std::filesystem::temp_directory_path() / "flotsam-validate-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw OutputError("no directory can be made at " + name);
        path_ = name;
    }
    ~ScratchDirectory()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchDirectory(const ScratchDirectory&) = delete;
    ScratchDirectory& operator=(const ScratchDirectory&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

} // namespace flotsam::validation
